#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes gradients.onnx, a network for the extractor onnx_features that nobody trained, byte for byte the same every time.

Input: "image", 1 x 1 x height x width of any size, grey from 0 to 1. Outputs: "scores", the ratio of determinant and
trace of the structure tensor (Harris and Stephens 1988; Foerstner 1986), and "descriptors" at a quarter of the
resolution, 128 numbers as in SIFT (Lowe 2004) without its rotation: rectified derivatives in 8 directions, blurred and
read on a grid of 4 x 4 points, 6 pixels apart.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "inference" / "models"))
from make_models import integer, integers, model, node, tensor, value_info  # noqa: E402


def gaussian(radius, sigma):
    line = [math.exp(-0.5 * (i / sigma) ** 2) for i in range(-radius, radius + 1)]
    total = sum(line) ** 2
    return [a * b / total for a in line for b in line]


weights, nodes = [], []


def convolution(source, output, shape, values, bias=None, pads=None, **attributes):
    """A layer with weights of outputs x inputs x rows x columns."""
    weights.append(tensor(output + "_weights", shape, values))
    inputs = [source, output + "_weights"]
    if bias is not None:
        weights.append(tensor(output + "_bias", [shape[0]], bias))
        inputs.append(output + "_bias")
    pads = pads if pads is not None else [shape[2] // 2, shape[3] // 2] * 2
    extra = [integer("group", attributes["group"])] if "group" in attributes else []
    extra += [integers(name, [attributes[name]] * 2) for name in ("strides", "dilations") if name in attributes]
    nodes.append(node("Conv", inputs, output, integers("kernel_shape", shape[2:]), integers("pads", pads), *extra))


def operation(kind, inputs, output):
    nodes.append(node(kind, inputs, output))


DIRECTIONS = 8
convolution("image", "blurred", [1, 1, 5, 5], gaussian(2, 1.0))
derivative = [-0.5, 0.0, 0.5]
across, down = [0.0] * 3 + derivative + [0.0] * 3, [0.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]
convolution("blurred", "gradients", [2, 1, 3, 3], across + down)

# Structure tensor: dx^2, dy^2, (dx + dy)^2, each blurred.
convolution("gradients", "parts", [3, 2, 1, 1], [1, 0, 0, 1, 1, 1])
operation("Mul", ["parts", "parts"], "squares")
convolution("squares", "tensors", [3, 1, 7, 7], gaussian(3, 1.5) * 3, group=3)
convolution("tensors", "left", [2, 3, 1, 1], [1, 0, 0, -0.5, -0.5, 0.5])  # a, c of [a c; c b]
convolution("tensors", "right", [2, 3, 1, 1], [0, 1, 0, -0.5, -0.5, 0.5])  # b, c
operation("Mul", ["left", "right"], "products")
convolution("products", "determinant", [1, 2, 1, 1], [1000, -1000])
convolution("tensors", "trace", [1, 3, 1, 1], [1, 1, 0], bias=[1e-4])
operation("Div", ["determinant", "trace"], "scores")

angles = [2 * math.pi * k / DIRECTIONS for k in range(DIRECTIONS)]
convolution("gradients", "derivatives", [DIRECTIONS, 2, 1, 1], [f(a) for a in angles for f in (math.cos, math.sin)])
operation("Relu", ["derivatives"], "rectified")
convolution("rectified", "pooled", [DIRECTIONS, 1, 9, 9], gaussian(4, 2.5) * DIRECTIONS, group=DIRECTIONS, strides=2)
one_of_16 = [1.0 if k == cell else 0.0 for cell in range(16) for k in range(16)]
convolution("pooled", "descriptors", [16 * DIRECTIONS, 1, 4, 4], one_of_16 * DIRECTIONS, pads=[4, 4, 5, 5],
            group=DIRECTIONS, strides=2, dilations=3)

size = ["height", "width"]
data = model(
    nodes,
    [value_info("image", [1, 1] + size)],
    [value_info("scores", [1, 1] + size), value_info("descriptors", [1, 16 * DIRECTIONS, "rows", "columns"])],
    weights,
)
(pathlib.Path(__file__).parent / "gradients.onnx").write_bytes(data)
