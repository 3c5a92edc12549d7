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
    form = {FLOAT: "f", FLOAT16: "e", INT64: "q"}[element]
    raw = struct.pack(f"<{len(values)}{form}", *values)
    return b"".join(number(1, s) for s in shape) + number(2, element) + content(8, name) + content(9, raw)


def integer(name, value):
    return content(5, content(1, name) + number(3, value) + number(20, 2))


def integers(name, values):
    return content(5, content(1, name) + b"".join(number(8, v) for v in values) + number(20, 7))


def real(name, value):
    return content(5, content(1, name) + varint(2 << 3 | 5) + struct.pack("<f", value) + number(20, 1))


def text(name, value):
    return content(5, content(1, name) + content(4, value) + number(20, 3))


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


def every_layer():
    """A small U-Net with every operator and way of padding that both engines know; its weights are of no use."""
    weights, nodes, state = [], [], 1

    def random_tensor(name, shape, spread):
        nonlocal state
        count = 1
        for side in shape:
            count *= side
        values = []
        for _ in range(count):
            state = (state * 1103515245 + 12345) % (1 << 31)
            values.append(spread * (state / (1 << 30) - 1.0))
        weights.append(tensor(name, shape, values))

    def layer(kind, inputs, output, *attributes):
        nodes.append(node(kind, inputs, output, *attributes))
        return output

    def conv(output, source, channels_in, channels, size, stride=1, pad=0, dilation=1, groups=1, kind="Conv", more=()):
        shape = ([channels_in, channels // groups] if kind == "ConvTranspose" else [channels, channels_in // groups])
        random_tensor(output + "_weight", shape + [size, size], 2.0 / (shape[1] * size * size) ** 0.5)
        random_tensor(output + "_bias", [channels], 0.5)
        return layer(kind, [source, output + "_weight", output + "_bias"], output, integers("kernel_shape", [size, size]),
                     integers("strides", [stride, stride]), integers("pads", [pad] * 4),
                     integers("dilations", [dilation, dilation]), integer("group", groups), *more)

    first = layer("Relu", [conv("first", "image", 3, 8, 3, pad=1)], "first_relu")
    inner = layer("Clip", [conv("inner", first, 8, 8, 3, pad=1, groups=8)], "inner_clip", real("min", 0.0), real("max", 6.0))
    skip = layer("Add", [first, conv("narrow", inner, 8, 8, 1)], "skip")
    half = layer("MaxPool", [skip], "half", integers("kernel_shape", [2, 2]), integers("strides", [2, 2]))
    deep = layer("LeakyRelu", [conv("deep", half, 8, 12, 3, stride=2, pad=1)], "deep_relu", real("alpha", 0.2))
    mean = layer("AveragePool", [deep], "mean", integers("kernel_shape", [3, 3]), integers("pads", [1] * 4))
    up = layer("Relu", [conv("up", mean, 12, 8, 3, stride=2, pad=1, kind="ConvTranspose",
                             more=[integers("output_padding", [1, 1])])], "up_relu")
    joined = layer("Concat", [half, up], "joined", integer("axis", 1))
    wide = layer("Sigmoid", [conv("wide", joined, 16, 8, 3, pad=2, dilation=2, groups=2)], "wide_sigmoid")
    top = layer("Relu", [conv("top", wide, 8, 6, 2, stride=2, kind="ConvTranspose")], "top_relu")
    last = layer("Concat", [skip, top], "last", integer("axis", 1))
    conv("scores", last, 14, 3, 1)
    return model(nodes, [value_info("image", [1, 3, "height", "width"])],
                 [value_info("scores", [1, 3, "height", "width"])], weights, opset=10)


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

    boxes = node("Reshape", ["scores", "box_shape"], "boxes")
    box_shape = tensor("box_shape", [3], [1, 8, 72], INT64)
    write("boxes", model([conv, boxes], [image], [value_info("boxes", [1, 8, 72])], weights + [box_shape]))
    mean = node("GlobalAveragePool", ["scores"], "means")
    write("whole_image", model([conv, mean], [value_info("image", [1, 3, 96, 128])],
                               [value_info("means", [1, 3, 1, 1])], weights))

    cast = node("Cast", ["labels"], "numbers", integer("to", FLOAT))
    numbers = value_info("numbers", [1, 1] + plane)
    write("cast_labels", model([conv, best, cast], [image], [numbers], weights))
    sigmoid = node("Sigmoid", ["score"], "share")
    write("sigmoid", model([one, sigmoid], [image], [value_info("share", [1, 1] + plane)], one_weights))

    # As PyTorch exports an interpolation to the size of the input, with every dimension of it free but the channels.
    parts = [coarse, node("Shape", ["image"], "image_shape"), node("Shape", ["scores"], "scores_shape"),
             node("Slice", ["image_shape", "two", "four", "zero"], "size"),
             node("Slice", ["scores_shape", "zero", "two", "zero"], "count"),
             node("Concat", ["count", "size"], "full_shape", integer("axis", 0)),
             node("Resize", ["scores", "", "", "full_shape"], "full", text("mode", "linear"),
                  text("coordinate_transformation_mode", "half_pixel"))]
    indices = [tensor(name, [1], [value], INT64) for name, value in [("zero", 0), ("two", 2), ("four", 4)]]
    write("resized", model(parts, [value_info("image", ["batch", 3, "height", "width"])],
                           [value_info("full", ["batch", 3, "height", "width"])], coarse_weights + indices, opset=11))

    write("every_layer", every_layer())

    total = node("Add", ["image", "other"], "sum")
    write("two_inputs", model([total], [image, value_info("other", [1, 3] + plane)],
                              [value_info("sum", [1, 3] + plane)], []))
    strange = node("Sorcery", ["image"], "scores")
    write("strange_layer", model([strange], [image], [scores], []))


if __name__ == "__main__":
    main()
