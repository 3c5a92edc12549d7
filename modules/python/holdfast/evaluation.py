# SPDX-License-Identifier: BSD-3-Clause
"""Comparison of an estimated trajectory with the truth."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Mapping, Optional, Union, Iterator

import numpy as np
import numpy.typing as npt

from . import _core
from .trajectory import Trajectory, read_trajectory

TrajectoryOrFile = Union[Trajectory, str, "os.PathLike[str]"]


class Evaluation(Mapping[str, Any]):
    """The errors of a trajectory: a mapping with the content of evaluation.json, and figures.

    docs/evaluation.md of the project defines every quantity.
    """

    def __init__(self, core: _core.Evaluation) -> None:
        self._core = core
        self._values: Dict[str, Any] = json.loads(core.to_json())

    def __getitem__(self, key: str) -> Any:
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    @property
    def ate_rmse(self) -> float:
        """Root mean square of the absolute error after the alignment [m]."""
        return float(self._values["ate_m"]["rmse"])

    @property
    def tracks(self) -> Dict[str, npt.NDArray[np.float64]]:
        """`truth` and `estimate` (N, 4): time [s], aligned position [m]; `error` (N, 2): time [s], error [m]."""
        return {
            name: np.array(rows, dtype=np.float64) for name, rows in json.loads(self._core.to_tracks_json()).items()
        }

    def to_text(self) -> str:
        """The table that `holdfast evaluate` prints."""
        return self._core.to_text()

    def to_csv(self) -> str:
        """Rows "quantity,statistic,value,unit" in full precision."""
        return self._core.to_csv()

    def path_svg(self) -> str:
        """Truth and estimate from above, as SVG."""
        return self._core.top_view_svg()

    def error_svg(self) -> str:
        """The absolute error over time, as SVG."""
        return self._core.error_svg()

    def __repr__(self) -> str:
        return f"Evaluation(ATE RMSE {self.ate_rmse:.4f} m over {len(self.tracks['error'])} poses)"

    def _repr_html_(self) -> str:
        from ._notebook import figure_row, preformatted

        return figure_row([self.path_svg(), self.error_svg()]) + preformatted(self.to_text())


def _trajectory(given: TrajectoryOrFile) -> Trajectory:
    return given if isinstance(given, Trajectory) else read_trajectory(given)


def evaluate(
    truth: TrajectoryOrFile,
    estimate: TrajectoryOrFile,
    *,
    alignment: str = "se3",
    max_time_difference: float = 0.02,
    time_step: float = 1.0,
    path_step: float = 1.0,
    frame_stamps: Optional[npt.ArrayLike] = None,
) -> Evaluation:
    """Computes absolute and relative errors of an estimate (ATE and RPE), as `holdfast evaluate` does.

    `truth` and `estimate` are trajectories or files in TUM's format. `alignment` is "se3", "sim3" (monocular) or
    "none"; poses belong together within `max_time_difference` [s]; `time_step` [s] and `path_step` [m] are those of
    the relative errors. With `frame_stamps` (N,) [s], the times of all frames, the coverage is computed.

    Raises Error for options out of range, and for fewer than three pairs of poses with the reason.
    """
    stamps: Optional[List[float]] = None
    if frame_stamps is not None:
        stamps = list(map(float, np.asarray(frame_stamps, dtype=np.float64)))
    return Evaluation(
        _core.evaluate(
            _trajectory(truth)._arrays(),
            _trajectory(estimate)._arrays(),
            alignment,
            max_time_difference,
            time_step,
            path_step,
            stamps,
        )
    )
