# SPDX-License-Identifier: BSD-3-Clause
"""Weights as .npz, which every version of PyTorch can read, and without batch normalisation for export."""
import zipfile

import cv2
import numpy as np
import torch
from torch import nn

from model import SIZES, UNet
from pack import PackError


def save_weights(path, model, size, input_size):
    """`model` is a state_dict."""
    arrays = {name: value.cpu().numpy() for name, value in model.items() if not name.endswith("num_batches_tracked")}
    np.savez(path, __size__=np.array(size), __input__=np.array(input_size), **arrays)


def load_weights(path):
    """(model for evaluation, width and height of its input)"""
    try:
        arrays = dict(np.load(path))
        size, input_size = str(arrays.pop("__size__")), tuple(int(value) for value in arrays.pop("__input__"))
        if size not in SIZES:
            raise ValueError(f"size '{size}', expected one of {', '.join(SIZES)}")
        model = UNet(size)
        state = {name: torch.from_numpy(value) for name, value in arrays.items()}
        missing, unexpected = model.load_state_dict(state, strict=False)
        missing = [name for name in missing if not name.endswith("num_batches_tracked")]
        if missing or unexpected:
            raise ValueError(f"missing {missing[:3]}, unexpected {unexpected[:3]}")
    except (OSError, KeyError, ValueError, RuntimeError, zipfile.BadZipFile) as error:
        raise PackError(f"{path}: cannot be read ({error}); expected weights.npz of a training") from error
    return model.eval(), input_size


def load_onnx(path):
    """The model in a file of export.py, for evaluation; its coarse heads know nothing."""
    try:
        net = cv2.dnn.readNetFromONNX(str(path))
    except cv2.error as error:
        raise PackError(f"{path}: cannot be read ({error.err}); expected unet.onnx as export.py writes it") from error
    blobs = [layer.blobs for layer in map(net.getLayer, net.getLayerNames()) if len(layer.blobs) == 2]
    for size in SIZES:
        model = UNet(size)
        layers = in_order(model)
        if [tuple(layer.weight.shape) for layer, _ in layers] == [weight.shape for weight, _ in blobs]:
            break
    else:
        raise PackError(f"{path}: holds a network of another shape; expected one of {', '.join(SIZES)}")
    with torch.no_grad():
        for (layer, norm), (weight, bias) in zip(layers, blobs):
            layer.weight.copy_(torch.from_numpy(weight))
            (norm or layer).bias.copy_(torch.from_numpy(bias.reshape(-1)))
            if norm:
                norm.weight.fill_((1.0 + norm.eps) ** 0.5)
        for head in model.coarse_heads:
            head.weight.zero_()
            head.bias.zero_()
    return model.eval()


def in_order(model):
    """Convolutions with their normalisation, or None, in the order in which a picture meets them."""
    def stage(layers):
        return [(layers[0], layers[1]), (layers[3], layers[4])]

    found = [(model.stem, None)] + [pair for layers in model.down for pair in stage(layers)]
    for grow, up in reversed(list(zip(model.grow, model.up))):
        found += [(grow, None)] + stage(up)
    return found + [(model.head, None)]


def with_normalisation(model, batches):
    """The same function, its batch normalisation, which export took away, ready to train on: mean and variance are those
    of the pictures (tensors) in `batches`, and scale and offset undo them."""
    sums, handles = {}, []

    def take_sums(norm, inputs):
        values = inputs[0].detach().double()
        count = values.numel() // values.shape[1]
        sums[norm] = sums.get(norm, 0) + torch.stack(
            [torch.full_like(values[0, :, 0, 0], count), values.sum((0, 2, 3)), (values ** 2).sum((0, 2, 3))])

    for _, norm in in_order(model):
        if norm:
            handles.append(norm.register_forward_pre_hook(take_sums))
    with torch.no_grad():
        for pictures in batches:
            model(pictures)
        for norm, (count, total, squares) in sums.items():
            mean = total / count
            variance = squares / count - mean ** 2
            norm.bias += mean.float()
            norm.running_mean.copy_(mean)
            norm.running_var.copy_(variance)
            norm.weight.copy_(torch.sqrt(norm.running_var + norm.eps))
    for handle in handles:
        handle.remove()
    return model


def folded(model):
    """The same function without batch normalisation: its scale and offset go into the convolution before it."""
    for stage in list(model.down) + list(model.up):
        for i in (0, 3):
            convolution, norm = stage[i], stage[i + 1]
            scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            weight = (convolution.weight * scale[:, None, None, None]).detach()
            bias = (norm.bias - norm.running_mean * scale).detach()
            plain = nn.Conv2d(convolution.in_channels, convolution.out_channels, 3, padding=1)
            plain.weight, plain.bias = nn.Parameter(weight), nn.Parameter(bias)
            stage[i], stage[i + 1] = plain, nn.Identity()
    return model
