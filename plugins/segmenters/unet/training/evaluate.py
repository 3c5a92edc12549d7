#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measure weights on what a pack holds out: photographs, people composed into rooms, rooms without anybody.

Photographs count at the size that they have in the pack.  For figures at their own size, and for outlines, run the
network in C++: `holdfast evaluate-segmentation --help`.
"""
import argparse
import pathlib
import sys

import torch

from measure import Validation
from pack import PackError, read_pack
from weights import load_weights


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pack", type=pathlib.Path)
    parser.add_argument("weights", type=pathlib.Path, nargs="+", help="weights.npz of trainings")
    parser.add_argument("--width", type=int, help="of the input [px] (default: as it was trained)")
    parser.add_argument("--height", type=int)
    parser.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    validation = Validation(*read_pack(arguments.pack))
    for path in arguments.weights:
        model, (width, height) = load_weights(path)
        width, height = arguments.width or width, arguments.height or height
        figures = validation(model, (width, height))
        print(f"{path} at {width}x{height}: " + "  ".join(f"{name} {value:.4f}" for name, value in figures.items()))


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"evaluate.py: {error}")
