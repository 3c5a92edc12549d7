# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories, evaluation, simulation and tables of a benchmark."""

import os
import pathlib
import subprocess
import sys

import numpy
import pytest

import holdfast


def turned(angle):
    pose = numpy.eye(4)
    pose[:2, :2] = [[numpy.cos(angle), -numpy.sin(angle)], [numpy.sin(angle), numpy.cos(angle)]]
    return pose


def spiral(count=50):
    poses = numpy.stack([turned(0.1 * index) for index in range(count)])
    poses[:, :3, 3] = numpy.stack(
        [numpy.cos(numpy.arange(count) / 5), numpy.sin(numpy.arange(count) / 5), numpy.arange(count) / 20], 1
    )
    return holdfast.Trajectory(numpy.arange(count) / 10, poses)


def test_trajectory_is_read_as_written(tmp_path):
    trajectory = spiral()
    trajectory.write(tmp_path / "poses.txt")
    read = holdfast.read_trajectory(tmp_path / "poses.txt")
    assert numpy.allclose(read.timestamps, trajectory.timestamps) and numpy.allclose(
        read.poses, trajectory.poses, atol=1e-8
    )
    rows = numpy.loadtxt(tmp_path / "poses.txt")
    assert numpy.allclose(rows[:, 1:4], trajectory.positions, atol=1e-8)
    signs = numpy.sign((rows[:, 4:] * trajectory.quaternions).sum(axis=1, keepdims=True))
    assert numpy.allclose(rows[:, 4:] * signs, trajectory.quaternions, atol=1e-8)
    assert read.to_text() == (tmp_path / "poses.txt").read_text()


def test_quaternions_of_half_turns():
    for axis in range(3):
        pose = -numpy.eye(4)
        pose[axis, axis] = pose[3, 3] = 1.0
        (quaternion,) = holdfast.Trajectory([0.0], [pose]).quaternions
        assert numpy.allclose(numpy.abs(quaternion), numpy.eye(4)[axis])


@pytest.mark.parametrize(
    "stamps, poses, message",
    [
        ([0.0], numpy.zeros((2, 4, 4)), "shape"),
        ([0.0], [numpy.diag([1, 1, 2, 1.0])], "pose 0: is no rigid motion"),
        ([numpy.inf], [numpy.eye(4)], "not finite"),
    ],
)
def test_other_poses_are_refused(stamps, poses, message):
    with pytest.raises(holdfast.InputError, match=message):
        holdfast.Trajectory(stamps, poses)


def test_empty_trajectory():
    empty = holdfast.Trajectory([], [])
    assert len(empty) == 0 and empty.quaternions.shape == (0, 4) and empty.length == 0.0


def test_evaluation_of_a_moved_copy(tmp_path):
    truth = spiral()
    moved = holdfast.Trajectory(truth.timestamps, turned(1.0) @ truth.poses)
    evaluation = holdfast.evaluate(truth, moved, frame_stamps=truth.timestamps)
    assert evaluation.ate_rmse < 1e-12 and evaluation["coverage"]["ratio"] == 1.0
    assert holdfast.evaluate(truth, moved, alignment="none").ate_rmse > 0.1
    assert evaluation.tracks["error"].shape == (50, 2) and "ATE" in evaluation.to_text()
    assert "<svg" in evaluation._repr_html_()
    truth.write(tmp_path / "truth.txt")
    assert holdfast.evaluate(tmp_path / "truth.txt", moved).ate_rmse < 1e-6
    with pytest.raises(holdfast.Error, match="pair"):
        holdfast.evaluate(truth, holdfast.Trajectory(truth.timestamps + 100.0, truth.poses))
    with pytest.raises(holdfast.InputError, match="did you mean 'se3'"):
        holdfast.evaluate(truth, moved, alignment="se2")


def test_simulation_is_a_sequence_with_truth():
    simulation = holdfast.simulate(overrides={"duration": 0.5})
    frames = list(simulation)
    assert len(frames) == len(simulation) == len(simulation.truth)
    last = frames[-1]
    assert numpy.array_equal(simulation[-1].colour, last.colour), "the same frame whenever it is asked for"
    assert numpy.array_equal(last.true_pose, simulation.truth.poses[-1])
    assert last.object_mask.shape == last.class_labels.shape == last.depth.shape == last.colour.shape[:2]
    assert last.moving_objects == []
    with pytest.raises(IndexError):
        simulation[len(simulation)]
    with pytest.raises(ValueError):
        last.colour[0, 0] = 0  # read-only: other frames may share it
    with pytest.raises(holdfast.ConfigurationError, match="durration"):
        holdfast.simulate(overrides={"durration": 1})


def test_frames_have_inertial_measurements():
    colour = numpy.zeros((4, 5, 3), numpy.uint8)
    rows = numpy.arange(14.0).reshape(2, 7)
    assert numpy.array_equal(holdfast.Frame(1.0, colour, imu=rows).imu, rows)
    assert holdfast.Frame(1.0, colour).imu.shape == (0, 7)
    with pytest.raises(holdfast.InputError, match="angular velocity"):
        holdfast.Frame(1.0, colour, imu=numpy.zeros((2, 6)))


def test_bench_tables_are_records(tmp_path):
    (tmp_path / "runs.csv").write_text(
        'variant,sequence,poses,ate_rmse_m,counts\n"a, b",xyz,-3,0.25,true\nc,rpy,,,false\n'
    )
    (tmp_path / "cells.csv").write_text("variant,coverage\na,1\n")
    results = holdfast.read_bench(tmp_path)
    assert results.runs == [
        {"variant": "a, b", "sequence": "xyz", "poses": -3, "ate_rmse_m": 0.25, "counts": True},
        {"variant": "c", "sequence": "rpy", "poses": None, "ate_rmse_m": None, "counts": False},
    ]
    assert "<table>" in results._repr_html_()
    with pytest.raises(holdfast.InputError, match="the folder holds runs, cells"):
        results.comparisons
    (tmp_path / "bench").mkdir()  # as `holdfast bench` writes them
    (tmp_path / "bench" / "tables").symlink_to(tmp_path)
    assert holdfast.read_bench(tmp_path / "bench").runs == results.runs
    with pytest.raises(holdfast.InputError, match="holds no results"):
        holdfast.read_bench(tmp_path / "nothing")
    pandas = pytest.importorskip("pandas")
    assert isinstance(results.frame("runs"), pandas.DataFrame)


def test_plots():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = spiral().plot(label="spiral")
    assert len(axes.lines) == 1 and axes.get_xlabel() == "x [m]"


def test_missing_extension_is_explained(tmp_path):
    package = tmp_path / "holdfast"
    package.mkdir()
    for file in pathlib.Path(holdfast.__file__).parent.glob("*.py"):
        (package / file.name).write_bytes(file.read_bytes())
    (package / "_core.cpython-32-x86_64-linux-gnu.so").touch()
    outcome = subprocess.run(
        [sys.executable, "-c", "import holdfast"],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        cwd=tmp_path,
    )
    assert outcome.returncode == 1
    last = outcome.stderr.splitlines()[-1]
    version = f"Python 3.{sys.version_info[1]} ({sys.executable})"
    assert last.startswith(f"ImportError: {package} holds no extension for {version}")
    assert "found: _core.cpython-32-x86_64-linux-gnu.so" in last and "pip install ." in last
