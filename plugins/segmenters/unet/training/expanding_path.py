# SPDX-License-Identifier: BSD-3-Clause
"""What the U-Nets have in common: from the planes of the contracting path back to scores."""
import torch
from torch import nn


class ExpandingPath(nn.Module):
    """A network with `dropout`, transposed convolutions `grow`, stages `up`, a `head` and `coarse_heads`."""

    def expand(self, skips):
        """Scores (before softmax) from planes of all resolutions, the finest first; in training a list, with coarser
        scores behind."""
        x = self.dropout(skips[-1])
        coarse = []
        for i in reversed(range(len(self.up))):
            x = self.up[i](torch.cat([skips[i], self.grow[i](x)], 1))
            if self.training and 0 < i <= len(self.coarse_heads):
                coarse.append(self.coarse_heads[i - 1](x))
        scores = self.head(x)
        return [scores] + coarse[::-1] if self.training else scores
