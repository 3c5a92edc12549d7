#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the tiny networks of the tests, byte for byte the same every time. Needs nothing but Python.

All of them score colours, pixel by pixel: class 0 "background" 1, class 1 "person" 8 * (red - 0.5),
class 2 "chair" 8 * (green - 0.5), for inputs from 0 to 1 in the order red green blue. Those for objects have the inputs,
outputs and metadata of real exports: they find a person in a fixed box if something is red, and a chair in another one
if something is green; prototype 0 is positive where it is red, prototype 1 where it is green.
"""
import pathlib
import struct

FLOAT, UINT8, INT8, INT64, FLOAT16 = 1, 2, 3, 7, 10
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
    form = {FLOAT: "f", UINT8: "B", INT8: "b", FLOAT16: "e", INT64: "q"}[element]
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


def model(nodes, inputs, outputs, weights, opset=12, metadata=None):
    graph = b"".join(nodes) + content(2, "colours") + b"".join(content(5, w) for w in weights)
    graph += b"".join(content(11, i) for i in inputs) + b"".join(content(12, o) for o in outputs)
    notes = b"".join(content(14, content(1, key) + content(2, value)) for key, value in (metadata or {}).items())
    return number(1, 7) + content(7, graph) + content(8, content(1, "") + number(2, opset)) + notes


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


COCO = """person bicycle car motorcycle airplane bus train truck boat traffic_light fire_hydrant stop_sign parking_meter
bench bird cat dog horse sheep cow elephant bear zebra giraffe backpack umbrella handbag tie suitcase frisbee skis
snowboard sports_ball kite baseball_bat baseball_glove skateboard surfboard tennis_racket bottle wine_glass cup fork
knife spoon bowl banana apple sandwich orange broccoli carrot hot_dog pizza donut cake chair couch potted_plant bed
dining_table toilet tv laptop mouse remote keyboard cell_phone microwave oven toaster sink refrigerator book clock vase
scissors teddy_bear hair_drier toothbrush"""
COCO = [name.replace("_", " ") for name in COCO.split()]
PERSON, CHAIR = 0, COCO.index("chair")
RED, GREEN, NOTHING = (1, 0, -1, 0), (0, 1, -1, 0), (0, 0, 0, 0)  # 0 for grey
PERSON_BOX, CHAIR_BOX = (200, 320, 240, 320), (480, 240, 200, 200)  # centre and size in an input of 640x640


def constant(value):
    return (0, 0, 0, value)


def ultralytics(title, task, size=(640, 640)):
    names = "{" + ", ".join(f"{i}: {name!r}" for i, name in enumerate(COCO)) + "}"
    return {"description": f"Ultralytics {title} model trained on coco.yaml", "author": "Ultralytics", "stride": "32",
            "task": task, "batch": "1", "imgsz": str(list(size)), "names": names}


class Objects:
    """A network for objects of an image of any size, as it is built."""

    def __init__(self):
        self.nodes, self.weights, self.sizes = [], [], {}

    def tensor(self, name, shape, values, element=FLOAT):
        self.weights.append(tensor(name, shape, values, element))
        return name

    def colours(self, name, kernel, rows, image="image"):
        """Rows of scores (red green blue, bias) of the mean colours of cells."""
        pooled = name + "_mean"
        self.nodes.append(node("AveragePool", [image], pooled, integers("kernel_shape", kernel), integers("strides", kernel)))
        self.tensor(name + "_weight", [len(rows), 3, 1, 1], [w for row in rows for w in row[:3]])
        self.tensor(name + "_bias", [len(rows)], [row[3] for row in rows])
        self.nodes.append(node("Conv", [pooled, name + "_weight", name + "_bias"], name, integers("kernel_shape", [1, 1])))
        return name

    def cells(self, name, kernel, rows):
        """The same as a list, 1 x rows x cells."""
        image = self.colours(name + "_image", kernel, rows)
        shape = self.tensor(name + "_shape", [3], [1, len(rows), -1], INT64)
        self.nodes.append(node("Reshape", [image, shape], name))
        return name

    def joined(self, name, lists):
        self.nodes.append(node("Concat", lists, name, integer("axis", 2)))
        return name

    def turned(self, name, source):
        self.nodes.append(node("Transpose", [source], name, integers("perm", [0, 2, 1])))
        return name

    def write(self, image, outputs, metadata=None):
        return model(self.nodes, [value_info("image", image)], [value_info(n, s) for n, s in outputs.items()],
                     self.weights, metadata=metadata)


def with_scores(box, count, scores, more=()):
    """Numbers of a cell: constants of the box, scores by class, and more numbers."""
    rows = [constant(v) for v in box] + [NOTHING] * count
    for number_of_class, row in scores.items():
        rows[len(box) + number_of_class] = row
    return rows + [constant(v) for v in more]


def coefficients(which, count=32):
    return [1.0 if i == which else 0.0 for i in range(count)]


def prototypes(net, name="output1"):
    return net.colours(name, [4, 4], [(1, 0, 0, -0.5), (0, 1, 0, -0.5)] + [NOTHING] * 30)


def yolo(name, title, masks, image=(1, 3, 640, 640), size=(640, 640), cells=8400, person=PERSON_BOX, chair=CHAIR_BOX):
    """YOLOv8: person boxes in the cells of stride 8, chairs in those of stride 16."""
    net = Objects()
    more = (lambda which: coefficients(which)) if masks else (lambda which: [])
    lists = [net.cells("fine", [8, 8], with_scores(person, 80, {PERSON: RED}, more(0))),
             net.cells("middle", [16, 16], with_scores(chair, 80, {CHAIR: GREEN}, more(1))),
             net.cells("coarse", [32, 32], with_scores((0, 0, 9, 9), 80, {}, more(2)))]
    net.joined("output0", lists)
    outputs = {"output0": [image[0], 116 if masks else 84, cells]}
    if masks:
        prototypes(net)
        outputs["output1"] = [image[0], 32, 160 if image[2] == 640 else "h", 160 if image[3] == 640 else "w"]
    return net.write(list(image), outputs, ultralytics(title, "segment" if masks else "detect", size))


def yolov5():
    """Three boxes for each cell, with objectness; no metadata of the task, as its exporter writes it."""
    net = Objects()
    fine = net.cells("fine", [8, 8], with_scores(PERSON_BOX + (1.0,), 80, {PERSON: RED}))
    middle = net.cells("middle", [16, 16], with_scores(CHAIR_BOX + (0.5,), 80, {CHAIR: GREEN}))
    coarse = net.cells("coarse", [32, 32], with_scores((0, 0, 9, 9, 0.0), 80, {PERSON: constant(1.0)}))
    net.turned("output0", net.joined("columns", [fine] * 3 + [middle] * 3 + [coarse] * 3))
    notes = ultralytics("", "")
    return net.write([1, 3, 640, 640], {"output0": [1, 25200, 85]}, {k: notes[k] for k in ("stride", "names")})


def corners(box):
    x, y, width, height = box
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def yolo_end_to_end():
    """300 boxes with score and class, no suppression needed."""
    net = Objects()
    def rows(box, score, number_of_class, which):
        return ([constant(v) for v in corners(box)] + [score, constant(number_of_class)] +
                [constant(v) for v in coefficients(which)])
    lists = [net.cells("people", [64, 64], rows(PERSON_BOX, RED, PERSON, 0)),
             net.cells("chairs", [64, 64], rows(CHAIR_BOX, GREEN, CHAIR, 1)),
             net.cells("rest", [64, 64], rows((0, 0, 9, 9), NOTHING, 0, 2))]
    net.turned("output0", net.joined("columns", lists))
    prototypes(net)
    return net.write([1, 3, 640, 640], {"output0": [1, 300, 38], "output1": [1, 32, 160, 160]},
                     ultralytics("YOLO26n-seg", "segment"))


FRACTION_BOX = (0.3125, 0.5, 0.375, 0.5)  # centre and size in parts of the input


def detr():
    net = Objects()
    logits = [constant(-10.0)] * 92
    logits[1], logits[91] = (4, 0, 0, 0), NOTHING
    net.turned("logits", net.cells("columns", [32, 32], logits))
    net.turned("pred_boxes", net.cells("box_columns", [32, 32], [constant(v) for v in FRACTION_BOX]))
    return net.write([1, 3, 320, 320], {"logits": [1, 100, 92], "pred_boxes": [1, 100, 4]})


def rtdetr():
    net = Objects()
    logits = [constant(-10.0)] * 80
    logits[PERSON] = (16, 0, 0, -8.0)
    net.turned("logits", net.joined("columns", [net.cells("cells", [64, 64], logits)] * 3))
    boxes = net.cells("box_cells", [64, 64], [constant(v) for v in FRACTION_BOX])
    net.turned("pred_boxes", net.joined("box_columns", [boxes] * 3))
    return net.write([1, 3, 640, 640], {"logits": [1, 300, 80], "pred_boxes": [1, 300, 4]})


def ssd():
    net = Objects()
    logits = [NOTHING] * 21
    logits[0], logits[15] = constant(4.0), (12, 0, 0, 0)
    boxes = [constant(v) for v in corners(FRACTION_BOX)]
    def all_cells(name, rows):
        fine = net.cells(name + "_fine", [10, 10], rows)
        coarse = net.cells(name + "_coarse", [15, 20], rows)
        return net.turned(name + "_rows", net.joined(name + "_columns", [fine] * 3 + [coarse]))
    net.nodes.append(node("Softmax", [all_cells("score", logits)], "scores", integer("axis", 2)))
    net.nodes.append(node("Identity", [all_cells("box", boxes)], "boxes"))
    return net.write([1, 3, 300, 300], {"scores": [1, 3000, 21], "boxes": [1, 3000, 4]})


def mask_rcnn():
    """As torchvision exports it: one image without a batch, and as many boxes, labels, scores and masks as there are."""
    rows = [(1, 0, 0, 0.0), (0, 1, 0, 0.0)]
    conv, weights = convolution(rows, "images", "planes")
    nodes = [node("Unsqueeze", ["image"], "images", integers("axes", [0])), conv,
             node("Transpose", ["planes"], "every_mask", integers("perm", [1, 0, 2, 3])),
             node("ReduceMax", ["every_mask"], "highest", integers("axes", [1, 2, 3]), integer("keepdims", 0)),
             node("Greater", ["highest", "half"], "is_there"), node("NonZero", ["is_there"], "row"),
             node("Reshape", ["row", "any"], "kept")]
    nodes += [node("Gather", ["every_" + part, "kept"], part) for part in ("box", "label", "score", "mask")]
    weights += [tensor("half", [], [0.5]), tensor("any", [1], [-1], INT64),
                tensor("every_box", [2, 4], [2, 2, 16, 22, 16, 2, 30, 22]), tensor("every_label", [2], [1, 62], INT64),
                tensor("every_score", [2], [0.75, 0.875])]
    outputs = [value_info("box", ["n", 4]), value_info("label", ["n"], INT64), value_info("score", ["n"]),
               value_info("mask", ["n", 1, "height", "width"])]
    return model(nodes, [value_info("image", [3, "height", "width"])], outputs, weights)


def maskformer():
    """Four queries of two classes and none: a person where it is red, a chair where it is green."""
    net = Objects()
    net.turned("zeros", net.cells("columns", [24, 8], [NOTHING] * 3))
    net.tensor("queries", [1, 4, 3], [0, 0, 9, 9, 0, 0, 0, 0, 9, 0, 6, 0])
    net.nodes.append(node("Add", ["zeros", "queries"], "class_queries_logits"))
    net.colours("masks_queries_logits", [4, 4], [(0, 0, 0, -1.0), (1, 0, 0, -0.5), (0, 0, 0, 1.0), (0, 1, 0, -0.5)])
    return net.write([1, 3, 24, 32], {"class_queries_logits": [1, 4, 3], "masks_queries_logits": [1, 4, 6, 8]})


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

    # 8 bits: pixels from 0 to 255, and weights in eighths.
    eighths = [round(8 * w) for row in SCORES for w in row[:3]]
    parts = [node("DequantizeLinear", ["image", "pixel_scale"], "colours"),
             node("DequantizeLinear", ["weight", "weight_scale"], "real_weight"),
             node("Conv", ["colours", "real_weight", "bias"], "scores", integers("kernel_shape", [1, 1]))]
    numbers = [tensor("pixel_scale", [], [1 / 255]), tensor("weight", [3, 3, 1, 1], eighths, INT8),
               tensor("weight_scale", [], [1 / 8]), tensor("bias", [3], [row[3] for row in SCORES])]
    write("quantised", model(parts, [value_info("image", [1, 3] + plane, UINT8)], [scores], numbers, opset=13))

    # An operator that is younger than OpenCV 4.6, between free dimensions; it keeps the order of the scores.
    parts = [conv, node("Transpose", ["scores"], "pixels", integers("perm", [0, 2, 3, 1])),
             node("LayerNormalization", ["pixels", "norm_scale"], "normal"),
             node("Transpose", ["normal"], "normal_scores", integers("perm", [0, 3, 1, 2]))]
    write("opset_17", model(parts, [free], [value_info("normal_scores", [1, 3, "height", "width"])],
                            weights + [tensor("norm_scale", [3], [1.0, 1.0, 1.0])], opset=17))

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

    write("yolov8n-seg", yolo("yolov8n-seg", "YOLOv8n-seg", masks=True))
    write("yolov8n", yolo("yolov8n", "YOLOv8n", masks=False))
    write("yolov8n-seg-dynamic", yolo("yolov8n-seg", "YOLOv8n-seg", masks=True, image=("batch", 3, "height", "width"),
                                      size=(96, 160), cells="anchors", person=(60, 48, 80, 60), chair=(120, 48, 40, 40)))
    write("yolov5s", yolov5())
    write("yolo26n-seg", yolo_end_to_end())
    write("detr", detr())
    write("rtdetr", rtdetr())
    write("ssd", ssd())
    write("mask_rcnn", mask_rcnn())
    write("maskformer", maskformer())

    total = node("Add", ["image", "other"], "sum")
    write("two_inputs", model([total], [image, value_info("other", [1, 3] + plane)],
                              [value_info("sum", [1, 3] + plane)], []))
    strange = node("Sorcery", ["image"], "scores")
    write("strange_layer", model([strange], [image], [scores], []))


if __name__ == "__main__":
    main()
