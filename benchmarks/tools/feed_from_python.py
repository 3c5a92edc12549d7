#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What it costs to feed frames from Python: time of Pipeline.feed() less that of the stages which C++ measures in it.

PYTHONPATH=build/python python3 benchmarks/tools/feed_from_python.py [DURATION_IN_SECONDS]

The difference contains what C++ does between its stages, so that it is an upper bound of the cost of Python.
"""
import statistics
import sys
import time

import numpy

import holdfast

simulation = holdfast.simulate(overrides={"duration": float(sys.argv[1]) if len(sys.argv) > 1 else 5.0})
frames = [(frame.timestamp, numpy.array(frame.colour), numpy.array(frame.depth)) for frame in simulation]
config = {"camera": "tum_fr1", "features": "orb", "optimizer": "ceres"}
whole, stages = [], []
with holdfast.Pipeline(config) as pipeline:
    for frame in frames:
        begin = time.perf_counter()
        result = pipeline.feed(*frame)
        whole.append(time.perf_counter() - begin)
        stages.append(sum(result.stage_seconds.values()))
difference = [1e6 * (a - b) for a, b in zip(whole, stages)]
print(f"{len(frames)} frames, feed() {1e3 * statistics.median(whole):.2f} ms in the median")
print(
    f"beyond the stages {statistics.median(difference):.0f} us in the median, "
    f"{100 * (sum(whole) - sum(stages)) / sum(stages):.2f} % of all time"
)
