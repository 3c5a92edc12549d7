# SPDX-License-Identifier: BSD-3-Clause
"""Camera poses over time."""

from __future__ import annotations

import os
from typing import Any, Iterator, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core

Array = npt.NDArray[np.float64]


class Trajectory:
    """Poses of the camera over time.

    `timestamps` is float64 (N,) [s], `poses` float64 (N, 4, 4): T_world_camera, rigid motions with translations in
    metres. Both are copied. Raises InputError for other shapes and for matrices that are no rigid motions.
    """

    def __init__(self, timestamps: npt.ArrayLike, poses: npt.ArrayLike) -> None:
        self.timestamps: Array = np.array(timestamps, dtype=np.float64)
        self.poses: Array = np.array(poses, dtype=np.float64).reshape(
            (-1, 4, 4) if np.size(poses) == 0 else np.shape(poses)
        )
        _core.check_trajectory(self.timestamps, self.poses)

    @classmethod
    def _of(cls, arrays: Tuple[Array, Array]) -> "Trajectory":
        trajectory = cls.__new__(cls)
        trajectory.timestamps, trajectory.poses = arrays
        return trajectory

    @property
    def positions(self) -> Array:
        """Positions of the camera in the world, float64 (N, 3) [m]; a view of `poses`."""
        return self.poses[:, :3, 3]

    @property
    def rotations(self) -> Array:
        """Rotation matrices from camera to world, float64 (N, 3, 3); a view of `poses`."""
        return self.poses[:, :3, :3]

    @property
    def quaternions(self) -> Array:
        """Unit quaternions x y z w of the rotations, float64 (N, 4), as in TUM's files; w is not negative."""
        r = self.rotations
        squares = np.stack(
            [
                1 + r[:, 0, 0] - r[:, 1, 1] - r[:, 2, 2],
                1 - r[:, 0, 0] + r[:, 1, 1] - r[:, 2, 2],
                1 - r[:, 0, 0] - r[:, 1, 1] + r[:, 2, 2],
                1 + r[:, 0, 0] + r[:, 1, 1] + r[:, 2, 2],
            ],
            axis=1,
        )
        # Each row of this matrix is 4 q_i q, so that the largest q_i gives all others without loss.
        products = np.empty((len(self), 4, 4))
        for i in range(4):
            products[:, i, i] = squares[:, i]
        for i, j in ((0, 1), (0, 2), (1, 2)):
            products[:, i, j] = products[:, j, i] = r[:, i, j] + r[:, j, i]
        for i, (j, k) in enumerate(((2, 1), (0, 2), (1, 0))):
            products[:, i, 3] = products[:, 3, i] = r[:, j, k] - r[:, k, j]
        rows = products[np.arange(len(self)), np.argmax(squares, axis=1)]
        rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
        quaternions: Array = np.where(rows[:, 3:] < 0, -rows, rows)
        return quaternions

    @property
    def length(self) -> float:
        """Length of the path through the positions [m]."""
        return float(np.linalg.norm(np.diff(self.positions, axis=0), axis=1).sum())

    @property
    def duration(self) -> float:
        """Time from the first to the last pose [s]; 0 for fewer than two."""
        return float(self.timestamps[-1] - self.timestamps[0]) if len(self) > 1 else 0.0

    def write(self, file: Union[str, "os.PathLike[str]"]) -> None:
        """Writes TUM's format, as trajectory.txt of a run. Raises InputError if the file cannot be written."""
        _core.write_trajectory(file, self.timestamps, self.poses)

    def to_text(self) -> str:
        """The content of the file that write() writes."""
        return _core.trajectory_text(self.timestamps, self.poses)

    def plot(self, axes: Optional[Any] = None, label: Optional[str] = None) -> Any:
        """Draws the path from above (x and z of the world) into matplotlib's axes and returns them."""
        from ._plots import plot_path

        return plot_path(self, axes, label)

    def __len__(self) -> int:
        return int(self.timestamps.shape[0])

    def __iter__(self) -> Iterator[Tuple[float, Array]]:
        """(timestamp, pose) in order."""
        return zip(map(float, self.timestamps), self.poses)

    def __getitem__(self, index: slice) -> "Trajectory":
        if not isinstance(index, slice):
            raise TypeError("a trajectory takes slices, as trajectory[10:20]; single poses are in trajectory.poses")
        return Trajectory._of((self.timestamps[index], self.poses[index]))

    def __repr__(self) -> str:
        return f"Trajectory({len(self)} poses, {self.duration:.2f} s, {self.length:.3f} m)"

    def _arrays(self) -> Tuple[Array, Array]:
        return self.timestamps, self.poses


def read_trajectory(file: Union[str, "os.PathLike[str]"]) -> Trajectory:
    """Reads a trajectory in TUM's format: timestamp tx ty tz qx qy qz qw.

    Poses are sorted by time; of several with one time the last counts, and those that are not finite are left out.
    Raises InputError with file and line for anything else.
    """
    return Trajectory._of(_core.read_trajectory(file))
