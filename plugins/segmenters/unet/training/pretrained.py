# SPDX-License-Identifier: BSD-3-Clause
"""MobileNetV2's weights, trained on ImageNet, from a quantised TensorFlow Lite file, as starting point of the contracting
path of the network `mobile`.

Reads only what such a file needs: a FlatBuffer (https://flatbuffers.dev/internals) with TensorFlow Lite's schema, and of
that the convolutions with 8 bit weights and 32 bit offsets.
"""
import struct

import numpy as np
import torch
from torch import nn

from pack import PackError
from weights import in_order, set_folded

CONV_2D, DEPTHWISE_CONV_2D = 3, 4  # BuiltinOperator
NUMBERS = {2: "<i4", 3: "u1", 9: "i1"}  # TensorType


class Table:
    """A table of a FlatBuffer; fields by their number in the schema."""

    def __init__(self, data, position):
        self.data, self.position = data, position
        self.fields = position - struct.unpack_from("<i", data, position)[0]
        self.end = struct.unpack_from("<H", data, self.fields)[0]

    def field(self, number):
        """Position of a field, or None."""
        entry = 4 + 2 * number
        offset = struct.unpack_from("<H", self.data, self.fields + entry)[0] if entry < self.end else 0
        return self.position + offset if offset else None

    def number(self, number, kind):
        position = self.field(number)
        return 0 if position is None else struct.unpack_from(kind, self.data, position)[0]

    def target(self, number):
        position = self.field(number)
        return position + struct.unpack_from("<I", self.data, position)[0]

    def table(self, number):
        return Table(self.data, self.target(number))

    def vector(self, number, kind):
        position = self.target(number)
        return np.frombuffer(self.data, kind, struct.unpack_from("<I", self.data, position)[0], position + 4)

    def tables(self, number):
        start = self.target(number) + 4
        offsets = self.vector(number, "<u4")
        return [Table(self.data, start + 4 * i + int(offset)) for i, offset in enumerate(offsets)]


def real_numbers(tensor, buffers, depthwise):
    """Value of a quantised tensor: (stored - zero point) * scale, the scale per tensor or per output channel."""
    stored = buffers[tensor.number(2, "<I")].vector(0, "u1").view(NUMBERS[tensor.number(1, "<b")])
    stored = stored.reshape(tensor.vector(0, "<i4")).astype(np.float32)
    quantisation = tensor.table(4)
    scale, zero = quantisation.vector(2, "<f4"), quantisation.vector(3, "<i8")
    if len(scale) > 1:
        channel_axis = stored.ndim - 1 if depthwise or stored.ndim == 1 else 0
        scale = scale.reshape([-1 if axis == channel_axis else 1 for axis in range(stored.ndim)])
    return (stored - np.float32(zero[0])) * scale


def convolutions(path):
    """(weights as PyTorch wants them, offsets) of every convolution, in the order of the network."""
    data = path.read_bytes()
    model = Table(data, struct.unpack_from("<I", data)[0])
    graph = model.tables(2)[0]
    tensors, buffers = graph.tables(0), model.tables(4)
    codes = [max(code.number(0, "<b"), code.number(3, "<i")) for code in model.tables(1)]
    found = []
    for operator in graph.tables(3):
        code = codes[operator.number(0, "<I")]
        if code in (CONV_2D, DEPTHWISE_CONV_2D):
            depthwise = code == DEPTHWISE_CONV_2D
            weight, offset = (real_numbers(tensors[k], buffers, depthwise) for k in operator.vector(1, "<i4")[1:3])
            weight = weight.transpose(3, 0, 1, 2) if depthwise else weight.transpose(0, 3, 1, 2)
            found.append((torch.from_numpy(np.ascontiguousarray(weight)), torch.from_numpy(offset)))
    return found


def load_encoder(model, path, pixel_scale):
    """Gives the contracting path of a MobileUNet the file's weights; returns its convolutions as in_order() does.
    `pixel_scale`: a pixel is this many times as large for the file's network as for ours."""
    model.eval()
    encoder = {layer for part in (model.stem, model.down) for layer in part.modules() if isinstance(layer, nn.Conv2d)}
    layers = [(layer, norm) for layer, norm in in_order(model) if layer in encoder]
    try:
        found = convolutions(path)[:len(layers)]
    except (struct.error, ValueError, KeyError, TypeError, IndexError) as error:
        raise PackError(f"{path}: cannot be read ({error}); expected a quantised TensorFlow Lite file") from error
    if [layer.weight.shape for layer, _ in layers] != [weight.shape for weight, _ in found]:
        raise PackError(f"{path}: holds another network; expected MobileNetV2 1.0")
    for i, ((layer, norm), (weight, offset)) in enumerate(zip(layers, found)):
        set_folded(layer, norm, weight * pixel_scale if i == 0 else weight, offset)
    return layers
