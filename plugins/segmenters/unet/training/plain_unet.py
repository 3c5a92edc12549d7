# SPDX-License-Identifier: BSD-3-Clause
"""The U-Net of Ronneberger et al., MICCAI 2015: every stage has two 3x3 convolutions (batch normalisation, ReLU); 2x2
maxima lead down, 2x2 transposed convolutions up, skip connections across, a 1x1 convolution gives the scores.

With `halves`, a 2x2 convolution with stride 2 precedes the first stage, so that the widest planes, which cost most and
say least, are gone; scores come out at half the input's size.
"""
from torch import nn
from torch.nn import functional

from classes import CLASSES, TOLD_APART
from expanding_path import ExpandingPath


class Stage(nn.Sequential):
    """Two 3x3 convolutions."""

    def __init__(self, channels_in, channels):
        layers = []
        for count in (channels_in, channels):
            layers += [nn.Conv2d(count, channels, 3, padding=1, bias=False), nn.BatchNorm2d(channels), nn.ReLU(True)]
        super().__init__(*layers)


class PlainUNet(ExpandingPath):
    """`widths`: channels of the stages, from the finest to the coarsest."""

    def __init__(self, widths, dropout=0.1, halves=True):
        super().__init__()
        self.stem = nn.Conv2d(3, widths[0], 2, stride=2) if halves else nn.Identity()
        self.down = nn.ModuleList(Stage(a, b) for a, b in zip((widths[0] if halves else 3,) + widths, widths))
        self.dropout = nn.Dropout2d(dropout)
        self.grow = nn.ModuleList(nn.ConvTranspose2d(b, a, 2, stride=2) for a, b in zip(widths, widths[1:]))
        self.up = nn.ModuleList(Stage(2 * width, width) for width in widths[:-1])
        self.head = nn.Conv2d(widths[0], len(CLASSES), 1)
        # Coarse scores, in training only: they tell the deep stages sooner what is wanted, and what else is there.
        self.coarse_heads = nn.ModuleList(nn.Conv2d(width, TOLD_APART, 1) for width in widths[1:4])

    def forward(self, picture):
        """Scores (before softmax); in training a list, with coarser ones behind."""
        x = self.stem(picture)
        skips = []
        for i, stage in enumerate(self.down):
            x = stage(functional.max_pool2d(x, 2) if i else x)
            skips.append(x)
        return self.expand(skips)
