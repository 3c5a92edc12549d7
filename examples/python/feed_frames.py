# SPDX-License-Identifier: BSD-3-Clause
"""Feeds frames as a robot would and looks at the map while it grows; the simulator stands for the camera.

python3 examples/python/feed_frames.py [DURATION_IN_SECONDS]
"""
import sys

import holdfast

camera = holdfast.simulate(overrides={"duration": float(sys.argv[1]) if len(sys.argv) > 1 else 3.0})
config = {"camera": "tum_fr1", "features": "orb", "optimizer": "ceres", "run": {"mode": "threaded"}}
config["tracking"] = {"rolling_shutter": "off"}  # the simulator exposes all rows of an image at once
with holdfast.Pipeline(config) as pipeline:
    for frame in camera:
        result = pipeline.feed(frame.timestamp, frame.colour, frame.depth)
        if result.T_world_camera is None:
            print(f"{frame.timestamp:.2f} s: {result.status}, {result.failure}")
        elif result.is_keyframe:
            x, y, z = result.T_world_camera[:3, 3]
            points = len(pipeline.map_snapshot().points)
            print(f"{frame.timestamp:.2f} s: keyframe at {x:.3f} {y:.3f} {z:.3f} m, {points} map points")
print(holdfast.evaluate(camera.truth, pipeline.trajectory()))
