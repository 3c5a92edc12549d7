#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Turn weights.npz into an ONNX file that the segmenter `unet` loads (opset 11, float32, one picture of any size whose
sides are multiples of what the depth wants).

Batch normalisation is folded into the convolutions, and the coarse heads of training are left out.

Example
  export.py out/base/weights.npz unet_base.onnx
  holdfast run rgbd.yaml --set 'segmenter={unet: {model: unet_base.onnx}}' --output out/run
"""
import argparse
import pathlib
import sys
import warnings

import torch

from classes import CLASSES, PERSON
from model import multiple
from pack import PackError
from weights import folded, load_weights


def export(model, input_size, path, caution=0.0, temperature=1.0, offsets=(0.0,) * len(CLASSES)):
    """`model`: for evaluation; it is changed. Scores are divided by the temperature: the same labels, other confidence."""
    model = folded(model.eval())
    with torch.no_grad():
        model.head.bias += torch.tensor(offsets)
        model.head.bias[PERSON] -= caution
        model.head.weight /= temperature
        model.head.bias /= temperature
    model.coarse_heads = torch.nn.ModuleList()
    picture = torch.zeros(1, 3, input_size[1], input_size[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about optional checks of the exporter
        torch.onnx.export(model, picture, str(path), opset_version=11, input_names=["picture"],
                          output_names=["scores"], do_constant_folding=True,
                          dynamic_axes={name: {2: "height", 3: "width"} for name in ("picture", "scores")})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights", type=pathlib.Path, help="weights.npz of a training")
    parser.add_argument("onnx", type=pathlib.Path, help="file to write")
    parser.add_argument("--caution", type=float, default=0.0,
                        help="subtracted from the score of 'person', where it is found too often (default: 0)")
    parser.add_argument("--offsets", type=float, nargs=len(CLASSES), default=[0.0] * len(CLASSES), metavar="SCORE",
                        help=f"added to the scores of {', '.join(CLASSES)}, where a class is found too seldom (default: 0)")
    parser.add_argument("--temperature", type=float, default=1.0,
                        help="divides the scores, so that confidence is a probability; calibrate.py finds it (default: 1)")
    arguments = parser.parse_args()
    if not arguments.temperature > 0.0:
        parser.error(f"a temperature of {arguments.temperature}; expected more than 0")
    model, (width, height) = load_weights(arguments.weights)
    export(model, (width, height), arguments.onnx, arguments.caution, arguments.temperature, arguments.offsets)
    print(f"{arguments.onnx}: size '{model.size}', trained for {width}x{height}, sides multiples of "
          f"{multiple(model.size)}, "
          f"{arguments.onnx.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"export.py: {error}")
