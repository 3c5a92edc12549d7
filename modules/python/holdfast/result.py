# SPDX-License-Identifier: BSD-3-Clause
"""What a whole run computed."""

from __future__ import annotations

import json
import os
import warnings
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._core import Camera, Configuration
from .evaluation import Evaluation
from .maps import Map
from .trajectory import Trajectory


#: Keys of run.json that were renamed.
_RENAMED = {
    "troubles": "tracking_failures",
    "pieces_begun": "submaps_begun",
    "joins_pieces": "joins_submaps",
    "way_m": "path_length_m",
}


class _RunJson(Dict[str, Any]):
    """A mapping of run.json that understands the earlier names of keys, with a warning."""

    def __missing__(self, key: str) -> Any:
        name = _RENAMED.get(key, key)
        if name not in self:
            raise KeyError(key)
        warnings.warn(f"'{key}' of run.json is now '{name}'", DeprecationWarning, stacklevel=2)
        return self[name]


class Result:
    """A run at its end: trajectory, map, evaluation, times and failures. `run_json` has the content of run.json."""

    def __init__(self, core: _core.RunRecord) -> None:
        self._core = core
        #: Poses of all tracked frames.
        self.trajectory: Trajectory = Trajectory._of(core.trajectory())
        #: Poses of the keyframes in the map.
        self.keyframes: Trajectory = Trajectory._of(core.keyframes())
        #: Times of all frames of the source, skipped ones included, float64 (N,) [s].
        self.frame_stamps: npt.NDArray[np.float64] = np.array(core.frame_stamps, dtype=np.float64)
        #: Errors against the truth; None where the source has none, `no_evaluation` says why.
        self.evaluation: Optional[Evaluation] = Evaluation(core.evaluation) if core.evaluation is not None else None
        self.no_evaluation: str = core.no_evaluation
        #: Content of run.json: version, counts, stage times, loops, machine.
        self.run_json: Dict[str, Any] = json.loads(core.run_json(), object_hook=_RunJson)

    @property
    def map(self) -> Map:
        """The map at the end of the run."""
        return Map(self._core.map())

    @property
    def dense_map(self) -> Optional[Tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]]:
        """Positions (N, 3) [m] and colours (N, 3, red green blue) of the scene; None without dense_map.enabled."""
        return self._core.dense_map

    @property
    def configuration(self) -> Configuration:
        """The resolved configuration of the run."""
        return self._core.configuration

    @property
    def camera(self) -> Camera:
        """The camera of the run."""
        return self._core.camera

    @property
    def coverage(self) -> float:
        """Share of the frames that have a pose, 0 to 1."""
        return float(self.run_json["frames"]["coverage"])

    @property
    def stages(self) -> List[Dict[str, Any]]:
        """Time per stage: stage, frames, median_s, p95_s, maximum_s, total_s and share of each."""
        stages: List[Dict[str, Any]] = self.run_json["stages"]
        return stages

    @property
    def tracking_seconds(self) -> npt.NDArray[np.float64]:
        """Time from images to pose of every frame, float64 (N,) [s]."""
        return self._core.tracking_seconds

    @property
    def warnings(self) -> List[str]:
        """What may be unintended: in the configuration, and a low coverage with what to check."""
        warnings: List[str] = self.run_json["warnings"]
        return warnings

    @property
    def interrupted(self) -> bool:
        """Whether the run was asked to end early."""
        return bool(self.run_json["interrupted"])

    def summary(self) -> str:
        """The text that `holdfast run` prints at the end."""
        return self._core.summary_text()

    def report_html(self) -> str:
        """The content of report.html, one page by itself."""
        return self._core.report_html()

    def write(self, folder: Union[str, "os.PathLike[str]"], overwrite: bool = False) -> None:
        """Writes the files of `holdfast run` into a folder. Raises InputError for one that is not empty."""
        self._core.write(folder, overwrite)

    def plot(self, axes: Optional[Any] = None) -> Any:
        """Draws the path, and the truth where there is one, into matplotlib's axes and returns them."""
        from ._plots import plot_result

        return plot_result(self, axes)

    def __repr__(self) -> str:
        error = f", ATE RMSE {self.evaluation.ate_rmse:.4f} m" if self.evaluation is not None else ""
        return f"Result({len(self.trajectory)} poses, coverage {100 * self.coverage:.1f} %{error})"

    def _repr_html_(self) -> str:
        from ._notebook import escaped, figure_row, stage_table

        figures = [self.evaluation.path_svg(), self.evaluation.error_svg()] if self.evaluation is not None else []
        warnings = "".join(f"<p><b>Warning:</b> {escaped(warning)}</p>" for warning in self.warnings)
        return f"<p>{escaped(repr(self))}</p>{warnings}{figure_row(figures)}{stage_table(self.stages)}"
