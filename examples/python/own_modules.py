# SPDX-License-Identifier: BSD-3-Clause
"""A segmenter and a filter in Python, selected by name as any module is.

python3 examples/python/own_modules.py [DURATION_IN_SECONDS]
"""
import sys
from typing import Annotated

import numpy
import numpy.typing

import holdfast


@holdfast.register("bright")
class Bright(holdfast.Segmenter):
    """Calls whatever is bright a person."""

    classes = ["background", "person"]

    def __init__(
        self, threshold: Annotated[int, holdfast.Parameter("grey level", minimum=0, maximum=255)] = 200
    ) -> None:
        self.threshold = threshold

    def segment(self, frame: holdfast.Frame) -> numpy.typing.NDArray[numpy.uint8]:
        return numpy.where(frame.colour.mean(axis=2) > self.threshold, 1, 0).astype(numpy.uint8)


@holdfast.register("near_border")
class NearBorder(holdfast.DynamicFilter):
    """Distrusts features near the border of the image."""

    def __init__(
        self, margin: Annotated[float, holdfast.Parameter("width of the border", minimum=0, unit="px")] = 20.0
    ) -> None:
        self.margin = margin

    def apply(self, context: holdfast.FilterContext, evidence: holdfast.StaticEvidence) -> None:
        x, y = context.features.raw_x, context.features.raw_y
        to_right, to_bottom = context.camera.width - x, context.camera.height - y
        distance = numpy.minimum(numpy.minimum(x, to_right), numpy.minimum(y, to_bottom))
        evidence.add(numpy.where(distance < self.margin, -1.0, 0.0))


if __name__ == "__main__":  # not where the program or the conformance tests import this file
    print(
        holdfast.run(
            {
                "source": {"simulated": {"duration": float(sys.argv[1]) if len(sys.argv) > 1 else 3.0}},
                "camera": "tum_fr1",
                "features": "orb",
                "optimizer": "ceres",
                "segmenter": {"bright": {"threshold": 220}},
                "filters": ["semantic_mask", {"near_border": {"margin": 10}}],
            }
        )
    )
