# SPDX-License-Identifier: BSD-3-Clause
"""Visual SLAM for rooms where people move.

A whole run of a configuration, as the program `holdfast run` does it::

    import holdfast
    result = holdfast.run("examples/configs/demo.yaml")
    result.trajectory.positions     # float64 (N, 3) [m]
    result.evaluation.ate_rmse     # [m]

Frame by frame, from NumPy arrays::

    with holdfast.Pipeline("robot.yaml") as pipeline:
        for timestamp, colour, depth in camera:
            result = pipeline.feed(timestamp, colour, depth)

Modules in Python are classes under a decorator, which configurations select by name: `holdfast.register`.

Units are metres, seconds, radians and pixels. A pose `T_world_camera` is float64 (4, 4) and maps points from the camera
frame (x right, y down, z forward) to the world frame.
"""

from . import _extension as _extension  # first: it explains a missing extension
from ._core import (
    Camera,
    Configuration,
    Frame,
    FrameFeatures,
    FrameResult,
    FilterContext,
    Health,
    MovingObject,
    ObservedMap,
    StaticEvidence,
    camera,
    camera_names,
    version as __version__,
)
from ._errors import CheckError, ConfigurationError, Diagnostic, Error, InputError, PluginError, RunError
from .bench import BenchResults, read_bench
from .configuration import load_config, modules
from .evaluation import Evaluation, evaluate
from .maps import Map, MapSnapshot, map_info, read_map
from .pipeline import Pipeline
from .plugins import (
    Creation,
    DynamicFilter,
    FeatureExtractor,
    Features,
    FrameSource,
    Observer,
    Parameter,
    Segmenter,
    register,
    registered,
    unregister,
)
from .result import Result
from .running import run
from .simulation import Simulation, simulate
from .trajectory import Trajectory, read_trajectory

__all__ = [
    "BenchResults",
    "Camera",
    "CheckError",
    "Configuration",
    "ConfigurationError",
    "Creation",
    "Diagnostic",
    "DynamicFilter",
    "Error",
    "Evaluation",
    "FeatureExtractor",
    "Features",
    "FilterContext",
    "Frame",
    "FrameFeatures",
    "FrameResult",
    "FrameSource",
    "Health",
    "InputError",
    "Map",
    "MapSnapshot",
    "MovingObject",
    "ObservedMap",
    "Observer",
    "Parameter",
    "Pipeline",
    "PluginError",
    "Result",
    "RunError",
    "Segmenter",
    "Simulation",
    "StaticEvidence",
    "Trajectory",
    "__version__",
    "camera",
    "camera_names",
    "evaluate",
    "load_config",
    "map_info",
    "modules",
    "read_bench",
    "read_map",
    "read_trajectory",
    "register",
    "registered",
    "run",
    "simulate",
    "unregister",
]
