# SPDX-License-Identifier: BSD-3-Clause
"""Weights as .npz, which every version of PyTorch can read, and without batch normalisation for export."""
import zipfile

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
