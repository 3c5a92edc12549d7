#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many labels would change if the network computed with eight-bit integers?

Rounds what an int8 engine rounds, and computes with float32 in between: the weights of every convolution to 255 values per
output channel, and its input to 255 values between the bounds that occur in calibration pictures (all, or a share of
the values).  The pictures are those that a pack trains on for calibration, and those that it holds out for comparison,
except the photographs of voc_person, which are there to measure.

Example
  int8_labels.py pack.npz ../unet.onnx
"""
import argparse
import pathlib
import sys

import torch

from classes import PERSON
from measure import found_labels
from pack import PackError, not_measured, read_pack
from weights import folded, load_onnx


class Input:
    """The input of one convolution: bounds while they are found, then rounding."""

    def __init__(self, share):
        self.share, self.low, self.high, self.rounds = share, 0.0, 0.0, False

    def __call__(self, _layer, inputs):
        values = inputs[0]
        if self.rounds:
            scale = max(self.high - self.low, 1e-12) / 255.0
            return (torch.round((values.clamp(self.low, self.high) - self.low) / scale) * scale + self.low,)
        sorted_values = values.reshape(-1)[::7].sort()[0]
        last = len(sorted_values) - 1
        self.low = min(self.low, float(sorted_values[round((1.0 - self.share) * last)]))
        self.high = max(self.high, float(sorted_values[round(self.share * last)]))
        return None


def round_weights(layer):
    transposed = isinstance(layer, torch.nn.ConvTranspose2d)
    weights = layer.weight.transpose(0, 1) if transposed else layer.weight
    scale = weights.abs().amax((1, 2, 3), keepdim=True).clamp(min=1e-12) / 127.0
    weights = torch.round(weights / scale) * scale
    layer.weight.copy_(weights.transpose(0, 1) if transposed else weights)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pack", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path, help="ONNX file as export.py writes it")
    parser.add_argument("--width", type=int, default=384, help="of the input [px] (default: 384)")
    parser.add_argument("--height", type=int, default=288)
    parser.add_argument("--pictures", type=int, default=24, help="for calibration (default: 24)")
    parser.add_argument("--share", type=float, default=0.9999,
                        help="of the values of a plane that lie below its bound (default: 0.9999)")
    parser.add_argument("--float-head", action="store_true", help="the last convolution is not rounded")
    parser.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    training, held_out = read_pack(arguments.pack)
    compared = not_measured(held_out) or training[1::2]
    calibration = training[::max(1, len(training) // arguments.pictures)]
    size = (arguments.width, arguments.height)
    model = folded(load_onnx(arguments.model).eval())
    expected = [found_labels(model, entry.picture, size) for entry in compared]
    layers = [layer for layer in model.modules() if isinstance(layer, (torch.nn.Conv2d, torch.nn.ConvTranspose2d))
              and layer not in set(model.coarse_heads) and not (arguments.float_head and layer is model.head)]
    inputs = [Input(arguments.share) for _ in layers]
    for layer, values in zip(layers, inputs):
        layer.register_forward_pre_hook(values)
    for entry in calibration:
        found_labels(model, entry.picture, size)
    with torch.no_grad():
        for layer, values in zip(layers, inputs):
            round_weights(layer)
            values.rounds = True
    found = [found_labels(model, entry.picture, size) for entry in compared]
    changed = sum(int((a != b).sum()) for a, b in zip(found, expected))
    pixels = sum(a.size for a in expected)
    people = [sum(int((a == PERSON).sum()) for a in labels) for labels in (expected, found)]
    print(f"{len(compared)} pictures: {100.0 * changed / pixels:.2f} % of {pixels} labels change; "
          f"pixels of people {people[0]}, {people[1]} with int8")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"int8_labels.py: {error}")
