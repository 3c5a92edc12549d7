#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Find the temperature by which scores must be divided so that the softmax probability of a label is the share of pixels
with it that are labelled correctly (Guo et al., On calibration of modern neural networks, ICML 2017, section 4.2).

The temperature minimises the cross entropy over the pictures that a pack holds out, except the photographs of
voc_person, which are there to measure, and over every n-th picture that it trains on.  Labels do not change with it.

Example
  calibrate.py pack.npz ../unet.onnx
  export.py out/2/weights.npz ../unet.onnx --temperature 1.2
"""
import argparse
import pathlib
import sys

import numpy as np
import torch
from torch.nn import functional

from classes import IGNORED, NOT_PERSON, is_other_thing
from pack import PackError, not_measured, read_pack
from photographs import resized
from samples import to_tensor
from weights import load_onnx, load_weights


def sampled_scores(model, entry, input_size, step):
    """Scores and labels of every step-th known pixel along rows and columns, at the size of the picture."""
    labels = np.where(is_other_thing(entry.labels), 0, entry.labels)[step // 2::step, step // 2::step]
    small, _ = resized(entry.picture, entry.labels, input_size)
    with torch.no_grad():
        scores = model(to_tensor(small)[None].contiguous(memory_format=torch.channels_last))
        scores = functional.interpolate(scores, size=entry.labels.shape, mode="bilinear", align_corners=False)
    known = (labels != IGNORED) & (labels != NOT_PERSON)
    return scores[0, :, step // 2::step, step // 2::step].numpy()[:, known].T, labels[known].astype(np.int64)


def cross_entropy(scores, labels, temperature):
    return float(functional.cross_entropy(torch.from_numpy(scores) / temperature, torch.from_numpy(labels)))


def calibration_error(scores, labels, temperature, bins=20):
    """Expected calibration error of all labels (equation 3 of the paper)."""
    confidence, found = torch.softmax(torch.from_numpy(scores) / temperature, 1).max(1)
    correct = found.numpy() == labels
    index = np.minimum((confidence.numpy() * bins).astype(int), bins - 1)
    difference = np.bincount(index, confidence.numpy() - correct, bins)
    return float(np.abs(difference).sum() / len(labels))


def best_temperature(scores, labels, low=0.3, high=5.0):
    """Golden-section search; the cross entropy is convex in the inverse temperature."""
    share = (np.sqrt(5.0) - 1.0) / 2.0
    a, b = 1.0 / high, 1.0 / low
    while b - a > 1e-3:
        c, d = b - share * (b - a), a + share * (b - a)
        if cross_entropy(scores, labels, 1.0 / c) < cross_entropy(scores, labels, 1.0 / d):
            b = d
        else:
            a = c
    return 2.0 / (a + b)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pack", type=pathlib.Path)
    parser.add_argument("weights", type=pathlib.Path, help="weights.npz of a training, or unet.onnx")
    parser.add_argument("--width", type=int, default=384, help="of the input [px] (default: 384)")
    parser.add_argument("--height", type=int, default=288)
    parser.add_argument("--every", type=int, default=15, help="every n-th training picture (default: 15; 0 = none)")
    parser.add_argument("--step", type=int, default=6, help="every n-th pixel along rows and columns (default: 6)")
    parser.add_argument("--threads", type=int, default=1)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    training, held_out = read_pack(arguments.pack)
    entries = not_measured(held_out)
    entries += training[::arguments.every] if arguments.every else []
    if not entries:
        raise PackError(f"{arguments.pack}: holds nothing to calibrate with; expected pictures that are held out, or --every")
    onnx = arguments.weights.suffix == ".onnx"
    model = load_onnx(arguments.weights) if onnx else load_weights(arguments.weights)[0]
    parts = [sampled_scores(model, entry, (arguments.width, arguments.height), arguments.step) for entry in entries]
    scores = np.concatenate([part[0] for part in parts])
    labels = np.concatenate([part[1] for part in parts])
    temperature = best_temperature(scores, labels)
    print(f"{len(entries)} pictures, {len(labels)} pixels: temperature {temperature:.3f}")
    for value in (1.0, temperature):
        print(f"at {value:.3f}: cross entropy {cross_entropy(scores, labels, value):.4f}, "
              f"calibration error {100 * calibration_error(scores, labels, value):.2f} %")


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"calibrate.py: {error}")
