# SPDX-License-Identifier: BSD-3-Clause
"""A U-Net whose contracting path is MobileNetV2 (Sandler et al., CVPR 2018) and whose expanding path consists of
depthwise-separable convolutions: a twentieth of the multiplications of plain 3x3 convolutions with as many channels.

The contracting path begins with weights that others trained on ImageNet (see pretrained.py).
"""
from torch import nn

from classes import CLASSES, TOLD_APART
from expanding_path import ExpandingPath

#: MobileNetV2's blocks: expansion, channels, number of blocks, stride of the first of them (table 2 of the paper).
BLOCKS = ((1, 16, 1, 1), (6, 24, 2, 2), (6, 32, 3, 2), (6, 64, 4, 2), (6, 96, 3, 1), (6, 160, 3, 2), (6, 320, 1, 1))
STEM = 32
#: Index of the last block of each resolution (a half, a quarter, ... of the input) and its channels.
ENDS = {0: 16, 2: 24, 5: 32, 12: 96, 16: 320}


def convolution(channels_in, channels, kernel=1, stride=1, groups=1, active=True):
    layers = [nn.Conv2d(channels_in, channels, kernel, stride, kernel // 2, groups=groups, bias=False),
              nn.BatchNorm2d(channels)]
    return nn.Sequential(*layers, *([nn.ReLU(True)] if active else []))


class InvertedResidual(nn.Module):
    """Expansion to more channels, depthwise 3x3 convolution, linear projection to few channels."""

    def __init__(self, channels_in, channels, stride, expansion):
        super().__init__()
        inner = channels_in * expansion
        self.adds = stride == 1 and channels_in == channels
        self.layers = nn.Sequential(
            *([convolution(channels_in, inner)] if expansion > 1 else []),
            convolution(inner, inner, 3, stride, groups=inner),
            convolution(inner, channels, active=False))

    def forward(self, x):
        return x + self.layers(x) if self.adds else self.layers(x)


class SeparableStage(nn.Sequential):
    """Two depthwise-separable 3x3 convolutions."""

    def __init__(self, channels_in, channels):
        super().__init__(convolution(channels_in, channels_in, 3, groups=channels_in), convolution(channels_in, channels),
                         convolution(channels, channels, 3, groups=channels), convolution(channels, channels))


class MobileUNet(ExpandingPath):
    """`widths`: channels of the expanding path from the finest resolution (half the input's) on."""

    def __init__(self, widths, dropout=0.1):
        super().__init__()
        self.stem = convolution(3, STEM, 3, 2)
        blocks, channels_in = [], STEM
        for expansion, channels, count, stride in BLOCKS:
            for i in range(count):
                blocks.append(InvertedResidual(channels_in, channels, stride if i == 0 else 1, expansion))
                channels_in = channels
        self.down = nn.ModuleList(blocks)
        skips = tuple(ENDS.values())
        self.dropout = nn.Dropout2d(dropout)
        self.grow = nn.ModuleList(nn.ConvTranspose2d(b, a, 2, stride=2) for a, b in zip(widths, widths[1:] + skips[-1:]))
        self.up = nn.ModuleList(SeparableStage(a + b, a) for a, b in zip(widths, skips))
        self.head = nn.Conv2d(widths[0], len(CLASSES), 1)
        self.coarse_heads = nn.ModuleList(nn.Conv2d(width, TOLD_APART, 1) for width in widths[1:4])

    def forward(self, picture):
        """Scores (before softmax) at half size; in training a list, with coarser ones behind."""
        x = self.stem(picture)
        skips = []
        for i, block in enumerate(self.down):
            x = block(x)
            if i in ENDS:
                skips.append(x)
        return self.expand(skips)
