# SPDX-License-Identifier: BSD-3-Clause
"""Maps of runs and what they hold."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from .trajectory import Trajectory

File = Union[str, "os.PathLike[str]"]


class MapSnapshot:
    """Keyframes, points and loops of a map at one time, copied; nothing changes it afterwards."""

    def __init__(self, core: _core.MapSnapshot) -> None:
        self._core = core
        #: float64 (N, 3): positions of the map points in the world [m].
        self.points: npt.NDArray[np.float64] = core.points
        #: uint64 (N,): ids of the points, stable during a run.
        self.point_ids: npt.NDArray[np.uint64] = core.point_ids
        #: uint32 (N,): number of keyframes that observe each point.
        self.observations: npt.NDArray[np.uint32] = core.observations
        #: float32 (N,): accumulated log-odds that each point is static; 0 = unknown.
        self.static_log_odds: npt.NDArray[np.float32] = core.static_log_odds
        #: Poses of the keyframes, oldest first.
        self.keyframes: Trajectory = Trajectory._of(core.keyframe_arrays())
        #: uint64 (K,): ids of the keyframes.
        self.keyframe_ids: npt.NDArray[np.uint64] = core.keyframe_ids
        #: uint64 (L, 2): ids of the older and the newer keyframe of each loop.
        self.loops: npt.NDArray[np.uint64] = core.loops

    def plot(self, axes: Optional[Any] = None) -> Any:
        """Draws points and keyframes from above into matplotlib's axes and returns them."""
        from ._plots import plot_map

        return plot_map(self, axes)

    def __repr__(self) -> str:
        return repr(self._core)


class Map:
    """The map of a run: keyframes with their features, and points."""

    def __init__(self, core: _core.Map) -> None:
        self._core = core

    def snapshot(self) -> MapSnapshot:
        """Keyframes, points and loops as arrays."""
        return MapSnapshot(self._core.snapshot())

    def write(self, file: File) -> None:
        """Writes map.hfm, which `run(..., map=file)` continues. Raises InputError if the file cannot be written."""
        self._core.write(file)

    def write_ply(self, file: File) -> None:
        """Writes the points as PLY. Raises InputError if the file cannot be written."""
        self._core.write_ply(file)

    def to_dict(self) -> Dict[str, Any]:
        """Everything but descriptors; docs/map_format.md of the project defines every member."""
        content: Dict[str, Any] = json.loads(self._core.to_json())
        return content

    @property
    def keyframe_count(self) -> int:
        """Number of keyframes."""
        return self._core.keyframe_count

    @property
    def point_count(self) -> int:
        """Number of map points."""
        return self._core.point_count

    def __repr__(self) -> str:
        return repr(self._core)


def read_map(file: File) -> Map:
    """Reads map.hfm. Raises InputError for a file that is missing, truncated, damaged or of a newer format."""
    return Map(_core.read_map(file))


def map_info(file: File) -> Dict[str, Any]:
    """Key figures of map.hfm, as `holdfast map info --json`, without the memory that the map takes."""
    info: Dict[str, Any] = json.loads(_core.map_info_json(file))
    return info
