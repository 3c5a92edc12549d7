# SPDX-License-Identifier: BSD-3-Clause
"""Weights as .npz, which every version of PyTorch can read, and without batch normalisation for export."""
import zipfile

import numpy as np
import onnx
import onnx.numpy_helper
import torch
from google.protobuf.message import DecodeError
from torch import nn

from model import SIZES, make_model, multiple
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
        model = make_model(size)
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
        graph = onnx.load(str(path)).graph
        values = {tensor.name: onnx.numpy_helper.to_array(tensor) for tensor in graph.initializer}
        blobs = [(values[node.input[1]].astype(np.float32), values[node.input[2]].astype(np.float32))
                 for node in graph.node if node.op_type in ("Conv", "ConvTranspose")]
    except (OSError, IndexError, KeyError, DecodeError) as error:
        raise PackError(f"{path}: cannot be read ({error}); expected unet.onnx as export.py writes it") from error
    for size in SIZES:
        model = make_model(size).eval()
        layers = in_order(model)
        if [tuple(layer.weight.shape) for layer, _ in layers] == [weight.shape for weight, _ in blobs]:
            break
    else:
        raise PackError(f"{path}: holds a network of another shape; expected one of {', '.join(SIZES)}")
    for (layer, norm), (weight, bias) in zip(layers, blobs):
        set_folded(layer, norm, torch.from_numpy(weight), torch.from_numpy(bias.reshape(-1)))
    with torch.no_grad():
        for head in model.coarse_heads:
            head.weight.zero_()
            head.bias.zero_()
    return model


def set_folded(layer, norm, weight, bias):
    """Gives a convolution and its normalisation (or None) weights that contain the normalisation already."""
    with torch.no_grad():
        layer.weight.copy_(weight)
        (norm or layer).bias.copy_(bias)
        if norm:
            norm.running_mean.zero_()
            norm.running_var.fill_(1.0)
            norm.weight.fill_((1.0 + norm.eps) ** 0.5)


def in_order(model):
    """Convolutions with their normalisation, or None, in the order in which a picture meets them."""
    found, handles = [], []

    def meet(layer, _inputs, _output):
        if isinstance(layer, nn.BatchNorm2d):
            found[-1] = (found[-1][0], layer)
        else:
            found.append((layer, None))

    for layer in model.modules():
        if isinstance(layer, (nn.Conv2d, nn.ConvTranspose2d, nn.BatchNorm2d)):
            handles.append(layer.register_forward_hook(meet))
    was_training = model.training
    with torch.no_grad():
        model.eval()(torch.zeros(1, 3, multiple(model.size), multiple(model.size)))
    model.train(was_training)
    for handle in handles:
        handle.remove()
    return found


def with_normalisation(model, batches, layers):
    """The same function, the batch normalisation of `layers` (of in_order), which export took away, ready to train on:
    mean and variance are those of the pictures (tensors) in `batches`, and scale and offset undo them."""
    sums, handles = {}, []

    def take_sums(norm, inputs):
        values = inputs[0].detach().double()
        count = values.numel() // values.shape[1]
        sums[norm] = sums.get(norm, 0) + torch.stack(
            [torch.full_like(values[0, :, 0, 0], count), values.sum((0, 2, 3)), (values ** 2).sum((0, 2, 3))])

    for _, norm in layers:
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
    names = {layer: name for name, layer in model.named_modules()}

    def put(layer, other):
        parent, _, child = names[layer].rpartition(".")
        setattr(model.get_submodule(parent), child, other)

    for convolution, norm in in_order(model):
        if norm:
            scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
            plain = nn.Conv2d(convolution.in_channels, convolution.out_channels, convolution.kernel_size,
                              convolution.stride, convolution.padding, groups=convolution.groups)
            plain.weight = nn.Parameter((convolution.weight * scale[:, None, None, None]).detach())
            plain.bias = nn.Parameter((norm.bias - norm.running_mean * scale).detach())
            put(convolution, plain)
            put(norm, nn.Identity())
    return model
