# SPDX-License-Identifier: BSD-3-Clause
"""A network of others that labels pictures without labels: DeepLab v3 with MobileNetV2, trained on PASCAL VOC and COCO,
from a quantised TensorFlow Lite file, computed with real numbers.

Reads what `deeplabv3_mnv2_pascal_quant.tflite` of https://github.com/google-coral/test_data (Apache License 2.0) needs:
convolutions, sums, averages over the image, concatenation and bilinear resizing.
"""
import struct

import torch
from torch import nn
from torch.nn import functional

from classes import CLASSES, IGNORED, IN_BOX, IN_NO_BOX, NOT_PERSON, PERSON, VOC
from pack import PackError
from pretrained import CONV_2D, DEPTHWISE_CONV_2D, Table, real_numbers

ADD, AVERAGE_POOL_2D, CONCATENATION, RESIZE_BILINEAR, QUANTIZE, ARG_MAX = 0, 1, 2, 23, 114, 56  # BuiltinOperator
ACTIVATIONS = {0: lambda x: x, 1: functional.relu, 3: functional.relu6}
SIDE = 513  # of the input [px]


class Teacher(nn.Module):
    """Scores of VOC's 21 classes, at a sixteenth of the input's size, for a batch of pictures."""

    def __init__(self, path):
        super().__init__()
        try:
            self.read(path.read_bytes())
        except (struct.error, ValueError, KeyError, TypeError, IndexError) as error:
            raise PackError(f"{path}: cannot be read ({error}); expected deeplabv3_mnv2_pascal_quant.tflite") from error

    def read(self, data):
        model = Table(data, struct.unpack_from("<I", data)[0])
        graph = model.tables(2)[0]
        tensors, buffers = graph.tables(0), model.tables(4)
        codes = [max(code.number(0, "<b"), code.number(3, "<i")) for code in model.tables(1)]
        self.steps, self.input = [], int(graph.vector(1, "<i4")[0])
        for operator in graph.tables(3):
            code = codes[operator.number(0, "<I")]
            inputs, output = operator.vector(1, "<i4").tolist(), int(operator.vector(2, "<i4")[0])
            if code == ARG_MAX:
                break
            attributes = {}
            if code in (CONV_2D, DEPTHWISE_CONV_2D):
                options, depthwise = operator.table(4), code == DEPTHWISE_CONV_2D
                weight, offset = (real_numbers(tensors[k], buffers, depthwise) for k in inputs[1:3])
                weight = weight.transpose(3, 0, 1, 2) if depthwise else weight.transpose(0, 3, 1, 2)
                weight = torch.from_numpy(weight.copy())
                self.register_buffer(f"weight{output}", weight)
                self.register_buffer(f"offset{output}", torch.from_numpy(offset.copy()))
                dilation = max(1, options.number(5 if depthwise else 4, "<i"))
                attributes = dict(stride=options.number(1, "<i"), groups=len(weight) if depthwise else 1, dilation=dilation,
                                  padding=weight.shape[2] // 2 * dilation)
                attributes["activation"] = options.number(4 if depthwise else 3, "<b")
                inputs = inputs[:1]
            elif code == RESIZE_BILINEAR:
                attributes = dict(size=tensors[output].vector(0, "<i4").tolist()[1:3])
                inputs = inputs[:1]
            elif code not in (ADD, AVERAGE_POOL_2D, CONCATENATION, QUANTIZE):
                raise ValueError(f"operator {code}")
            self.steps.append((code, inputs, output, attributes))

    def forward(self, pictures):
        """`pictures`: N x 3 x SIDE x SIDE, red green blue, from -1 to 1."""
        values = {self.input: pictures}
        for code, inputs, output, attributes in self.steps:
            x = [values[k] for k in inputs]
            if code in (CONV_2D, DEPTHWISE_CONV_2D):
                attributes = dict(attributes)
                activation = ACTIVATIONS[attributes.pop("activation")]
                y = activation(functional.conv2d(x[0], getattr(self, f"weight{output}"), getattr(self, f"offset{output}"),
                                                 **attributes))
            elif code == ADD:
                y = x[0] + x[1]
            elif code == AVERAGE_POOL_2D:
                y = x[0].mean((2, 3), keepdim=True)
            elif code == CONCATENATION:
                y = torch.cat(x, 1)
            elif code == RESIZE_BILINEAR:
                if attributes["size"][0] == SIDE:
                    return x[0]
                y = functional.interpolate(x[0], size=attributes["size"], mode="bilinear", align_corners=True)
            else:
                y = x[0]
            values[output] = y
        return y


def probabilities(teacher, pictures, size):
    """Of every class of VOC, height x width of `size`; mean over the pictures (0 to 1, N x 3 x H x W) and their mirror
    images. Pictures are stretched to the teacher's input."""
    inputs = functional.interpolate(pictures, size=(SIDE, SIDE), mode="bilinear", align_corners=False) * 2.0 - 1.0
    scores = teacher(inputs).float()
    mirrored = teacher(inputs.flip(3)).float().flip(3)
    scores = [functional.interpolate(x, size=size, mode="bilinear", align_corners=False) for x in (scores, mirrored)]
    return 0.5 * (torch.softmax(scores[0], 1) + torch.softmax(scores[1], 1))


def own_classes(probability):
    """Of the classes of ours, background first, from those of VOC (N x 21 x H x W)."""
    ours = torch.zeros_like(probability[:, :len(CLASSES)])
    for voc, label in VOC.items():
        if voc != IGNORED and label < len(CLASSES):
            ours[:, label] = probability[:, voc]
    ours[:, 0] = 1.0 - ours[:, 1:].sum(1)
    return ours


def labels_of(probability, hints, sure=(1.0, 0.7, 0.5, 0.5, 0.5), possible=0.08, near=0.06):
    """Labels of probabilities (N x classes x H x W): a class where it is sure; background where every class of ours is
    improbable; otherwise nobody's.  `hints` (N x H x W): what is known of boxes of people.  In a box a person is likely, and
    background is believed only `near` (share of the width) a person that was found, elsewhere the box is nobody's; in none a
    person is not believed, and where one is unlikely, nothing that is unsure is a person."""
    best, label = probability[:, 1:].max(1)
    person, label = probability[:, PERSON], label + 1
    labels = torch.full_like(label, IGNORED)
    labels[best < possible] = 0
    labels = torch.where(best > torch.tensor(sure, device=best.device)[label], label, labels)
    in_box, in_none = hints == IN_BOX, hints == IN_NO_BOX
    reach = max(1, round(near * person.shape[2]))
    found = functional.max_pool2d(functional.avg_pool2d(person[:, None], 3, 1, 1), 2 * reach + 1, 1, reach)[:, 0] > 0.5
    labels = torch.where(in_box & (labels == 0) & ~found, IGNORED, labels)
    labels = torch.where(in_box & (person > 0.5), PERSON, labels)
    labels = torch.where(in_none & (person < 0.3) & (labels == IGNORED), NOT_PERSON, labels)
    return torch.where(in_none & (person >= 0.3), IGNORED, labels).to(torch.uint8)
