# SPDX-License-Identifier: BSD-3-Clause
"""A segmenter, a filter and, with OpenCV, an extractor that keep the contracts of their interfaces."""

from typing import Annotated

import numpy

import holdfast


@holdfast.register("dark_parts")
class DarkParts(holdfast.Segmenter):
    """Calls dark pixels a person, surely where they are darkest."""

    classes = ["background", "person"]
    movable = ["person"]

    def __init__(self, threshold: Annotated[int, holdfast.Parameter("grey level", minimum=0, maximum=255)]):
        self.threshold = threshold

    def segment(self, frame):
        if frame.colour is None:
            return None
        grey = frame.colour.mean(axis=2)
        return (grey < self.threshold).astype(numpy.uint8), (255 - grey).astype(numpy.uint8)


@holdfast.register("far_away")
class FarAway(holdfast.DynamicFilter):
    """Trusts what is far away, and what lies on the background."""

    needs = ["depth"]

    def __init__(self, distance: Annotated[float, holdfast.Parameter("least depth", minimum=0, unit="m")] = 2.0):
        self.distance = distance

    def apply(self, context, evidence):
        depth = numpy.nan_to_num(context.features.depth, nan=0.0, posinf=0.0, neginf=0.0)
        evidence.add(numpy.where(depth > self.distance, 0.5, 0.0))


try:
    import cv2
except ImportError:
    pass
else:

    @holdfast.register("cv_orb")
    class CvOrb(holdfast.FeatureExtractor):
        """ORB of OpenCV."""

        levels = 8
        factor = 1.2

        def __init__(self):
            self.orb = cv2.ORB_create(500)

        def extract(self, grey, ignore):
            if min(grey.shape) < 64:
                return None
            mask = None if ignore is None else numpy.where(ignore == 0, 255, 0).astype(numpy.uint8)
            keypoints, descriptors = self.orb.detectAndCompute(grey, mask)
            if not keypoints:
                return None
            return holdfast.Features(
                [k.pt[0] for k in keypoints],
                [k.pt[1] for k in keypoints],
                descriptors,
                octave=[k.octave for k in keypoints],
                angle=numpy.radians([k.angle for k in keypoints]) % 6.283185,
                response=[k.response for k in keypoints],
            )
