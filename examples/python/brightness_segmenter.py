# SPDX-License-Identifier: BSD-3-Clause
"""A segmenter in Python: whatever is brighter than its surroundings counts as a person. It shows the form, not the art.

    segmenter: { python: { file: ../python/brightness_segmenter.py, parameters: { threshold: 200 } } }
"""
import numpy


class Segmenter:
    classes = ["background", "person"]  # by label; 255 would mean unknown
    movable = ["person"]  # may be left out

    def __init__(self, threshold=180):  # `parameters` of the configuration, by name
        self.threshold = threshold

    def segment(self, image):  # uint8, rows x columns x (red, green, blue)
        grey = image.mean(axis=2)
        labels = (grey > self.threshold).astype(numpy.uint8)
        certainty = numpy.minimum(255, 4 * numpy.abs(grey - self.threshold)).astype(numpy.uint8)
        return labels, certainty  # or labels alone, or None where there is nothing to say
