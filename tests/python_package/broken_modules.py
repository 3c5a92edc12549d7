# SPDX-License-Identifier: BSD-3-Clause
"""A segmenter that remembers, and a filter that counts: the conformance tests must find both."""

import numpy

import holdfast


@holdfast.register("remembers")
class Remembers(holdfast.Segmenter):
    """Gives other labels with every call, whoever calls."""

    classes = ["background", "person"]
    calls = 0

    def segment(self, frame):
        Remembers.calls += 1
        return numpy.full(frame.colour.shape[:2], Remembers.calls % 2, numpy.uint8)


@holdfast.register("counts")
class Counts(holdfast.DynamicFilter):
    """Adds evidence that depends on the number of calls in the process."""

    calls = 0

    def apply(self, context, evidence):
        Counts.calls += 1
        evidence.add(numpy.full(len(evidence), 0.01 * Counts.calls))
