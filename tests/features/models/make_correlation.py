#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes correlation.onnx, a network for the matcher onnx_matcher that nobody trained, byte for byte the same every time.

Inputs: keypoints and descriptors of two images, 600 each: "keypoints0" and "keypoints1" (1 x 600 x 2, from -1 to 1),
"descriptors0" and "descriptors1" (1 x 600 x 128). Output: "scores" (1 x 600 x 600), the dot product of two
descriptors plus that of the keypoints, so that every input counts.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "inference" / "models"))
from make_models import integers, model, node, value_info  # noqa: E402

COUNT, LENGTH = 600, 128

nodes = [
    node("Transpose", ["descriptors1"], "turned", integers("perm", [0, 2, 1])),
    node("MatMul", ["descriptors0", "turned"], "likeness"),
    node("Transpose", ["keypoints1"], "points", integers("perm", [0, 2, 1])),
    node("MatMul", ["keypoints0", "points"], "nearness"),
    node("Add", ["likeness", "nearness"], "scores"),
]
inputs = [value_info(f"keypoints{k}", [1, COUNT, 2]) for k in (0, 1)]
inputs += [value_info(f"descriptors{k}", [1, COUNT, LENGTH]) for k in (0, 1)]
data = model(nodes, inputs, [value_info("scores", [1, COUNT, COUNT])], [])
(pathlib.Path(__file__).parent / "correlation.onnx").write_bytes(data)
