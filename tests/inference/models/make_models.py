#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tiny networks of the tests, byte for byte the same every time. Needs nothing but Python.

All of them score colours, pixel by pixel: class 0 "background" 1, class 1 "person" 8 * (red - 0.5),
class 2 "chair" 8 * (green - 0.5), for inputs from 0 to 1 in the order red green blue.
"""
import pathlib
import struct

FLOAT, INT64, FLOAT16 = 1, 7, 10
HEIGHT, WIDTH = 12, 16


def varint(value):
    value &= (1 << 64) - 1
    out = bytearray()
    while True:
        byte, value = value & 0x7F, value >> 7
        out.append(byte | (0x80 if value else 0))
        if not value:
            return bytes(out)


def number(field, value):
    return varint(field << 3) + varint(value)


def content(field, value):
    data = value.encode() if isinstance(value, str) else value
    return varint(field << 3 | 2) + varint(len(data)) + data


def value_info(name, shape, element=FLOAT):
    dims = b"".join(content(1, content(2, s) if isinstance(s, str) else number(1, s)) for s in shape)
    return content(1, name) + content(2, content(1, number(1, element) + content(2, dims)))


def tensor(name, shape, values, element=FLOAT):
    form = {FLOAT: "f", FLOAT16: "e"}[element]
    raw = struct.pack(f"<{len(values)}{form}", *values)
    return b"".join(number(1, s) for s in shape) + number(2, element) + content(8, name) + content(9, raw)


def integer(name, value):
    return content(5, content(1, name) + number(3, value) + number(20, 2))


def integers(name, values):
    return content(5, content(1, name) + b"".join(number(8, v) for v in values) + number(20, 7))


def node(kind, inputs, output, *attributes):
    ins = b"".join(content(1, i) for i in inputs)
    return content(1, ins + content(2, output) + content(3, output + "_node") + content(4, kind) + b"".join(attributes))


def model(nodes, inputs, outputs, weights, opset=12):
    graph = b"".join(nodes) + content(2, "colours") + b"".join(content(5, w) for w in weights)
    graph += b"".join(content(11, i) for i in inputs) + b"".join(content(12, o) for o in outputs)
    return number(1, 7) + content(7, graph) + content(8, content(1, "") + number(2, opset))


SCORES = [(0, 0, 0, 1.0), (8, 0, 0, -4.0), (0, 8, 0, -4.0)]  # weights of red green blue, and bias


def convolution(rows, image, output, stride=1, element=FLOAT):
    weights = [w for row in rows for w in row[:3]]
    return (node("Conv", [image, "weight", "bias"], output, integers("kernel_shape", [1, 1]),
                 integers("strides", [stride, stride])),
            [tensor("weight", [len(rows), 3, 1, 1], weights, element),
             tensor("bias", [len(rows)], [row[3] for row in rows], element)])


def main():
    folder = pathlib.Path(__file__).parent
    image = value_info("image", [1, 3, HEIGHT, WIDTH])
    plane = [HEIGHT, WIDTH]

    def write(name, data):
        (folder / f"{name}.onnx").write_bytes(data)

    conv, weights = convolution(SCORES, "image", "scores")
    scores = value_info("scores", [1, 3] + plane)
    write("logits", model([conv], [image], [scores], weights))
    free = value_info("image", [1, 3, "height", "width"])
    write("any_size", model([conv], [free], [value_info("scores", [1, 3, "height", "width"])], weights))

    softmax = node("Softmax", ["scores"], "shares", integer("axis", 1))
    shares = value_info("shares", [1, 3] + plane)
    write("probabilities", model([conv, softmax], [image], [shares], weights, opset=13))
    write("two_outputs", model([conv, softmax], [image], [scores, shares], weights, opset=13))

    best = node("ArgMax", ["scores"], "labels", integer("axis", 1), integer("keepdims", 1))
    write("labels", model([conv, best], [image], [value_info("labels", [1, 1] + plane, INT64)], weights))

    coarse, coarse_weights = convolution(SCORES, "image", "scores", stride=4)
    write("coarse", model([coarse], [image], [value_info("scores", [1, 3, 3, 4])], coarse_weights))

    one, one_weights = convolution(SCORES[1:2], "image", "score")
    write("one_channel", model([one], [image], [value_info("score", [1, 1] + plane)], one_weights))

    first = node("Transpose", ["image"], "planes", integers("perm", [0, 3, 1, 2]))
    middle, last_weights = convolution(SCORES, "planes", "score_planes")
    last = node("Transpose", ["score_planes"], "scores", integers("perm", [0, 2, 3, 1]))
    write("channels_last", model([first, middle, last], [value_info("image", [1] + plane + [3])],
                                 [value_info("scores", [1] + plane + [3])], last_weights))

    flat = node("Flatten", ["scores"], "flat", integer("axis", 1))
    write("flat", model([conv, flat], [image], [value_info("flat", [1, 3 * HEIGHT * WIDTH])], weights))

    half, half_weights = convolution(SCORES, "image", "scores", element=FLOAT16)
    write("half", model([half], [value_info("image", [1, 3] + plane, FLOAT16)],
                        [value_info("scores", [1, 3] + plane, FLOAT16)], half_weights))

    total = node("Add", ["image", "other"], "sum")
    write("two_inputs", model([total], [image, value_info("other", [1, 3] + plane)],
                              [value_info("sum", [1, 3] + plane)], []))
    strange = node("Sorcery", ["image"], "scores")
    write("strange_layer", model([strange], [image], [scores], []))


if __name__ == "__main__":
    main()
