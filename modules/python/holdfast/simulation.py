# SPDX-License-Identifier: BSD-3-Clause
"""Simulated scenes with exact truth."""

from __future__ import annotations

import os
from typing import Iterator, List, Union

from . import _core
from ._core import Camera, Frame
from .configuration import Overrides, _override_texts
from .trajectory import Trajectory


class Simulation:
    """The frames of a simulated scene: a sequence that renders each frame when it is asked for.

    Frames have truth: `true_pose`, `object_mask`, `class_labels` (indices into `class_names`) and `moving_objects`. The
    same scene, camera and index give the same frame. Any thread may use it.
    """

    def __init__(self, core: _core.Simulator) -> None:
        self._core = core

    @property
    def camera(self) -> Camera:
        """The camera of the frames."""
        return self._core.camera

    @property
    def class_names(self) -> List[str]:
        """Names of the class labels, by index; 0 is the static world."""
        return self._core.class_names

    @property
    def truth(self) -> Trajectory:
        """The exact pose of every frame."""
        return Trajectory._of(self._core.truth())

    def __len__(self) -> int:
        return self._core.frame_count

    def __getitem__(self, index: int) -> Frame:
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} is beyond the {len(self)} frames of the scene")
        return self._core.frame(index % len(self))

    def __iter__(self) -> Iterator[Frame]:
        for index in range(len(self)):
            yield self._core.frame(index)

    def __repr__(self) -> str:
        return f"Simulation({len(self)} frames, {self.camera!r})"


def simulate(
    scene: Union[str, "os.PathLike[str]"] = "",
    overrides: Overrides = {},
    *,
    camera: Union[str, Camera] = "tum_fr1",
    stereo_baseline: float = 0.0,
) -> Simulation:
    """A simulated scene as a sequence of frames with truth.

    `scene` is a scene file (docs/scenes.md of the project), "" the empty office; `overrides` are values by key path,
    such as {"duration": 2, "camera.path": "halfsphere"}. With a `stereo_baseline` [m] frames are stereo pairs: `right`
    in place of `depth`. Raises ConfigurationError with every problem found, InputError for a negative baseline.
    """
    known = _core.camera(camera) if isinstance(camera, str) else camera
    return Simulation(_core.Simulator(os.fspath(scene), _override_texts(overrides), known, stereo_baseline))
