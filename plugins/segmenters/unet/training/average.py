#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Average the weights of two trainings, the second of which began from the first: what the first was better at comes back
(Wortsman et al., Model soups, ICML 2022).  Mean and variance of the batch normalisation are those of pictures of a pack
afterwards, because averaged weights leave less variance (Jordan et al., REPAIR, ICLR 2023).  Without a pack, weights that
contain the normalisation are averaged, which is as good if the trainings are close.

Example
  average.py ../unet.onnx out/5/weights.npz pack.npz --share 0.6 --output out/6/weights.npz
"""
import argparse
import pathlib
import sys

import torch

from pack import PackError, read_pack
from photographs import resized
from samples import to_tensor
from weights import folded, in_order, load_onnx, load_weights, save_weights, set_folded, with_normalisation


def without_normalisation(path):
    """Weights that contain the normalisation, whatever file they are from."""
    model = load_onnx(path) if path.suffix == ".onnx" else load_weights(path)[0]
    if path.suffix == ".npz":
        for (convolution, norm), (plain, _) in zip(in_order(model), in_order(folded(load_weights(path)[0]))):
            if norm:
                set_folded(convolution, norm, plain.weight, plain.bias)
    return model


def normalised(path, batches):
    """Weights whose batch normalisation is measured on the same pictures."""
    model = without_normalisation(path)
    return with_normalisation(model, batches, in_order(model)) if batches else model


def averaged(first, second, share, batches):
    before, after = first.state_dict(), second.state_dict()
    first.load_state_dict({name: value + share * (after[name] - value) if value.dtype.is_floating_point else value
                           for name, value in before.items()})
    if not batches:
        return first.eval()
    for norm in first.modules():
        if isinstance(norm, torch.nn.BatchNorm2d):
            norm.reset_running_stats()
            norm.momentum = None  # the mean of all batches
            norm.train()
    with torch.no_grad():
        for pictures in batches:
            first(pictures)
    return first.eval()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=pathlib.Path, help="weights.npz or unet.onnx")
    parser.add_argument("second", type=pathlib.Path, help="weights.npz or unet.onnx of a training that began from it")
    parser.add_argument("pack", type=pathlib.Path, nargs="?")
    parser.add_argument("--share", type=float, default=0.6, help="of the second (default: 0.6)")
    parser.add_argument("--pictures", type=int, default=40, help="to measure the normalisation on (default: 40)")
    parser.add_argument("--width", type=int, default=384, help="of the input [px] (default: 384)")
    parser.add_argument("--height", type=int, default=288)
    parser.add_argument("--output", type=pathlib.Path, required=True, help="weights.npz, for export.py")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    entries = read_pack(arguments.pack)[0] if arguments.pack else []
    chosen = entries[::max(1, len(entries) // arguments.pictures)][:arguments.pictures]
    size = (arguments.width, arguments.height)
    pictures = [to_tensor(resized(entry.picture, entry.labels, size)[0]) for entry in chosen]
    count = max(1, len(pictures) // 8)
    batches = [torch.stack(pictures[i::count]) for i in range(count)] if pictures else []
    model = averaged(normalised(arguments.first, batches), normalised(arguments.second, batches), arguments.share, batches)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    save_weights(arguments.output, model.state_dict(), model.size, size)


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"average.py: {error}")
