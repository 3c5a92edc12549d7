# SPDX-License-Identifier: BSD-3-Clause
"""The networks that can be trained, by name."""
from mobile_unet import MobileUNet
from plain_unet import PlainUNet

#: For every name: how the network is made, and width and height of its input unless the user says otherwise [px].
SIZES = {
    "tiny": (lambda dropout: PlainUNet((8, 16, 24), dropout), (64, 48)),  # for tests
    "plain": (lambda dropout: PlainUNet((16, 32, 96, 160, 256), dropout), (256, 192)),
    "paper": (lambda dropout: PlainUNet((64, 128, 256, 512, 1024), dropout, halves=False), (320, 256)),
    "mobile": (lambda dropout: MobileUNet((24, 40, 64, 96), dropout), (384, 288)),
}


def make_model(size, dropout=0.1):
    model = SIZES[size][0](dropout)
    model.size = size
    return model


def multiple(size):
    """Width and height of the input are multiples of this."""
    return 8 if size == "tiny" else 32
