# SPDX-License-Identifier: BSD-3-Clause
"""Figures by matplotlib, which is needed for these alone."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Optional

if TYPE_CHECKING:
    from .maps import MapSnapshot
    from .result import Result
    from .trajectory import Trajectory


def _axes(axes: Optional[Any]) -> Any:
    if axes is None:
        try:
            pyplot = importlib.import_module("matplotlib.pyplot")
        except ImportError as error:
            raise ImportError(
                "plots need matplotlib, which is not installed; install python3-matplotlib (Debian) or matplotlib (pip)"
            ) from error
        axes = pyplot.subplots()[1]
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]")
    return axes


def plot_path(trajectory: "Trajectory", axes: Optional[Any], label: Optional[str]) -> Any:
    """Path in the plane of x and z of the world, that of the first camera's floor."""
    axes = _axes(axes)
    axes.plot(trajectory.positions[:, 0], trajectory.positions[:, 2], label=label)
    axes.set_ylabel("z [m]")
    return axes


def plot_map(snapshot: "MapSnapshot", axes: Optional[Any]) -> Any:
    """Points and keyframes in the plane of x and z of the world."""
    axes = _axes(axes)
    axes.scatter(snapshot.points[:, 0], snapshot.points[:, 2], s=1, c="0.6", linewidths=0)
    return plot_path(snapshot.keyframes, axes, "keyframes")


def plot_result(result: "Result", axes: Optional[Any]) -> Any:
    """The estimate, aligned with the truth where there is one."""
    if result.evaluation is None:
        return plot_path(result.trajectory, axes, "estimate")
    axes = _axes(axes)
    for name in ("truth", "estimate"):
        track = result.evaluation.tracks[name]
        axes.plot(track[:, 1], track[:, 2], label=name)
    axes.set_ylabel("y [m]")
    axes.legend()
    axes.set_title(f"ATE RMSE {1e3 * result.evaluation.ate_rmse:.1f} mm")
    return axes
