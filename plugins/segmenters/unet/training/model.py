# SPDX-License-Identifier: BSD-3-Clause
"""The U-Net: Ronneberger et al., MICCAI 2015, slim enough for one core of a laptop.

A first 2x2 convolution with stride 2 halves the input, so that the widest planes, which cost most and say least, are
gone; scores come out at half the input's size.  Then every stage has two 3x3 convolutions (batch normalisation, ReLU);
2x2 maxima lead down, 2x2 transposed convolutions up, skip connections across, a 1x1 convolution gives the scores.
"""
import torch
from torch import nn
from torch.nn import functional

from classes import CLASSES, TOLD_APART

#: Widths of the stages, from the finest to the coarsest, and width x height of the input.
SIZES = {
    "tiny": ((8, 16, 24), (64, 48)),  # for tests
    "base": ((16, 32, 96, 160, 256), (256, 192)),
    "large": ((48, 96, 192, 288, 384), (320, 256)),
}


def multiple(size):
    """Width and height of the input are multiples of this."""
    return 2 ** len(SIZES[size][0])


class Stage(nn.Sequential):
    """Two 3x3 convolutions."""

    def __init__(self, channels_in, channels):
        layers = []
        for count in (channels_in, channels):
            layers += [nn.Conv2d(count, channels, 3, padding=1, bias=False), nn.BatchNorm2d(channels), nn.ReLU(True)]
        super().__init__(*layers)


class UNet(nn.Module):
    def __init__(self, size, dropout=0.1):
        super().__init__()
        self.size = size
        widths = SIZES[size][0]
        self.stem = nn.Conv2d(3, widths[0], 2, stride=2)
        self.down = nn.ModuleList(Stage(a, b) for a, b in zip((widths[0],) + widths, widths))
        self.dropout = nn.Dropout2d(dropout)
        self.grow = nn.ModuleList(nn.ConvTranspose2d(b, a, 2, stride=2) for a, b in zip(widths, widths[1:]))
        self.up = nn.ModuleList(Stage(2 * width, width) for width in widths[:-1])
        self.head = nn.Conv2d(widths[0], len(CLASSES), 1)
        # Coarse scores, in training only: they tell the deep stages sooner what is wanted, and what else is there.
        self.coarse_heads = nn.ModuleList(nn.Conv2d(width, TOLD_APART, 1) for width in widths[1:4])

    def forward(self, picture):
        """Scores (before softmax) at half size; in training a list, with coarser ones behind."""
        x = self.stem(picture)
        skips = []
        for i, stage in enumerate(self.down):
            x = stage(functional.max_pool2d(x, 2) if i else x)
            skips.append(x)
        x = self.dropout(x)
        coarse = []
        for i in reversed(range(len(self.up))):
            x = self.up[i](torch.cat([skips[i], self.grow[i](x)], 1))
            if self.training and 0 < i <= len(self.coarse_heads):
                coarse.append(self.coarse_heads[i - 1](x))
        scores = self.head(x)
        return [scores] + coarse[::-1] if self.training else scores
