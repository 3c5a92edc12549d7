#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes gist.onnx, a network for the loop detector global that nobody trained, byte for byte the same every time.

Input: "image", 1 x 3 x 96 x 128, colours from 0 to 1. Output: "gist", 384 numbers after Oliva and Torralba, "Modeling the
shape of the scene" (IJCV 2001): rectified derivatives in 8 directions, averaged over 6 x 8 cells of 16 x 16 pixels, from
which the mean of the neighbouring cells is subtracted, so that different places have different vectors.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "inference" / "models"))
from make_models import integer, integers, model, node, tensor, value_info  # noqa: E402

weights, nodes = [], []


def convolution(source, output, shape, values, groups=1):
    """A layer with weights of outputs x inputs x rows x columns."""
    weights.append(tensor(output + "_weights", shape, values))
    nodes.append(node("Conv", [source, output + "_weights"], output, integers("kernel_shape", shape[2:]),
                      integers("pads", [shape[2] // 2, shape[3] // 2] * 2), integer("group", groups)))


DIRECTIONS = 8
line = [math.exp(-0.5 * (i / 1.5) ** 2) for i in range(-3, 4)]
blur = [a * b / sum(line) ** 2 / 3 for a in line for b in line]
convolution("image", "grey", [1, 3, 7, 7], blur * 3)
derivative = [-0.5, 0.0, 0.5]
across, down = [0.0] * 3 + derivative + [0.0] * 3, [0.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]
convolution("grey", "gradients", [2, 1, 3, 3], across + down)
angles = [2 * math.pi * k / DIRECTIONS for k in range(DIRECTIONS)]
convolution("gradients", "derivatives", [DIRECTIONS, 2, 1, 1], [f(a) for a in angles for f in (math.cos, math.sin)])
nodes.append(node("Relu", ["derivatives"], "rectified"))
nodes.append(node("AveragePool", ["rectified"], "cells", integers("kernel_shape", [16, 16]), integers("strides", [16, 16])))
convolution("cells", "contrasts", [DIRECTIONS, 1, 3, 3], ([-0.125] * 4 + [1.0] + [-0.125] * 4) * DIRECTIONS, DIRECTIONS)
nodes.append(node("Flatten", ["contrasts"], "gist", integer("axis", 1)))

data = model(nodes, [value_info("image", [1, 3, 96, 128])], [value_info("gist", [1, DIRECTIONS * 48])], weights)
(pathlib.Path(__file__).parent / "gist.onnx").write_bytes(data)
