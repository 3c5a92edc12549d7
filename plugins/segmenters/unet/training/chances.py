#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Label pictures of which only boxes of people are known with the chance of a person in every pixel.

The chance is the mean of several looks at a picture: of the teacher (teacher.py), and of a network of ours at two sizes
of input and in a mirror (Radosavovic et al., Data distillation, CVPR 2018).  Writes DIR/classes/NAME.png for every
DIR/boxes/NAME.txt, for `prepare.py --further DIR`; labels that are there already stay.

Example
  chances.py further --network ../unet.onnx --teacher deeplabv3_mnv2_pascal_quant.tflite
"""
import argparse
import pathlib
import sys

import cv2
import numpy as np
import torch
from torch.nn import functional

from classes import CHANCE, IGNORED, NOT_PERSON, PERSON, is_chance
from pack import PackError
from photographs import resized
from prepare import boxes_in, colour
from samples import to_tensor
from teacher import SIDE, Teacher, own_classes
from weights import folded, load_onnx


class Looks:
    """The mean of all looks at a picture: probabilities of our classes (classes x height x width)."""

    def __init__(self, network, teacher):
        self.network, self.teacher = folded(load_onnx(network)), Teacher(teacher).eval()

    def __call__(self, picture):
        def seen(size):
            return to_tensor(resized(picture, picture[:, :, 0], size)[0])[None]

        def probability(scores):
            scores = functional.interpolate(scores, picture.shape[:2], mode="bilinear", align_corners=False)
            return torch.softmax(scores, 1)

        large = seen((512, 384))
        with torch.no_grad():
            own = [probability(self.network(large)), probability(self.network(large.flip(3)).flip(3)),
                   probability(self.network(seen((384, 288))))]
            taught = own_classes(probability(self.teacher(seen((SIDE, SIDE)) / 2.0)))  # wants -1 to 1
        return (0.2 * sum(own) + 0.4 * taught)[0].numpy()


def chances(probability, boxes, impossible=0.04):
    """Labels of probabilities (classes x height x width).  `boxes`: of people, rows of left, top, right, bottom [px].  Where
    less than 15 % of a box is a person, one was missed: the rest of the box is ignored.  Outside of all boxes whoever is
    likely is ignored, and whoever is not is background."""
    person, furniture = probability[PERSON], probability[PERSON + 1:]
    labels = np.where(person < impossible, 0, CHANCE + np.round(100.0 * person)).astype(np.uint8)
    unlikely = person < 0.25
    labels[unlikely & (furniture.sum(0) > 0.12)] = NOT_PERSON
    sure = unlikely & (furniture.max(0) > 0.5)
    labels[sure] = (furniture.argmax(0) + PERSON + 1)[sure]
    outside = np.ones(person.shape, bool)
    margin = max(2, int(0.03 * person.shape[1]))
    for left, top, right, bottom in boxes:
        inside = (slice(top, bottom), slice(left, right))
        if person[inside].size and np.mean(person[inside] > 0.5) < 0.15:
            labels[inside][person[inside] < 0.5] = IGNORED
        outside[max(0, top - margin):bottom + margin, max(0, left - margin):right + margin] = False
    labels[outside & (person >= 0.3)] = IGNORED
    labels[outside & (person < 0.3) & is_chance(labels)] = 0
    return labels


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR", help="with images and boxes")
    parser.add_argument("--network", type=pathlib.Path, required=True, help="unet.onnx of export.py")
    parser.add_argument("--teacher", type=pathlib.Path, required=True, help="deeplabv3_mnv2_pascal_quant.tflite")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    looks = Looks(arguments.network, arguments.teacher)
    (arguments.folder / "classes").mkdir(exist_ok=True)
    for path in sorted((arguments.folder / "boxes").glob("*.txt")):
        target = arguments.folder / "classes" / f"{path.stem}.png"
        if target.exists():
            continue
        picture = colour(arguments.folder / "images" / f"{path.stem}.jpg")
        labels = chances(looks(picture), boxes_in(path, picture.shape[:2]))
        part = target.with_suffix(".part.png")  # a label image that is there is whole
        cv2.imwrite(str(part), labels)
        part.replace(target)


if __name__ == "__main__":
    try:
        main()
    except (PackError, OSError) as error:
        sys.exit(f"chances.py: {error}")
