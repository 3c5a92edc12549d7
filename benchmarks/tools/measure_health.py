#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measure the health of poses against the truth: NEES of covariances, errors that were announced, false alarms.

    holdfast run CONFIG --output RUN --set observers='[health]' ...     for each recording, simulated for instance
    measure_health.py [--truth groundtruth.txt] RUN [RUN ...]

NEES is that of the pose relative to the reference keyframe, as FrameResult::covariance means it, of frames whose pose the
map determined. The relative poses of trajectory.txt are those of the time of each frame. An error begins where a
reported pose is more than 5 cm off the truth (poses aligned at the first frame), 1 s after the last one; it is announced
if a frame of the second until then is not good. A false alarm is a frame with a pose that is not good although no pose
of the following two seconds is 5 cm off. Those within a second of a frame without a pose are also counted apart: that the
camera was, or is about to be, lost is no false word.

With --truth, the truth is that of a recording in TUM layout: the nearest stamp within 0.01 s counts, and all poses are
aligned by least squares in place of the first, because a measured pose is not exact. There is no NEES then: the errors of
such a truth, some millimetres, are larger than the standard deviations that it is to judge.

Needs: Debian's python3-numpy.
"""
import argparse
import csv
import os
import sys

import numpy as np

BIG, BEFORE, AFTER = 0.05, 1.0, 2.0  # [m], [s], [s]


def pose(values):
    x, y, z, w = np.array(values[3:], float) / np.linalg.norm(np.array(values[3:], float))
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    T[:3, 3] = np.array(values[:3], float)
    return T


def inverse(T):
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = T[:3, :3].T, -T[:3, :3].T @ T[:3, 3]
    return result


def tangent(T):
    """Logarithm of a small motion: translation, rotation."""
    R = T[:3, :3]
    r = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    return np.r_[T[:3, 3] - np.cross(r, T[:3, 3]) / 2, r]


def read_truth(path):
    """Stamps and poses of a trajectory in TUM format."""
    rows = [line.split() for line in open(path) if line.strip() and not line.startswith("#")]
    return np.array([float(row[0]) for row in rows]), [pose(row[1:8]) for row in rows]


def add_truth(frames, truth):
    stamps, poses = truth
    for frame in frames:
        nearest = np.abs(stamps - float(frame["timestamp"])).argmin()
        frame["truth"] = poses[nearest] if abs(stamps[nearest] - float(frame["timestamp"])) <= 0.01 else None


def with_both(frames):
    """Those that have a pose and a true one."""
    return [f for f in frames if f["pose"] is not None and f["truth"] is not None]


def alignment(frames, by_all):
    """The motion that takes estimated poses to true ones: of the first pose, or of all positions (Horn 1987)."""
    both = with_both(frames)
    if not by_all:
        return both[0]["truth"] @ inverse(both[0]["pose"])
    a, b = (np.array([f[name][:3, 3] for f in both]) for name in ("pose", "truth"))
    U, _, V = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    T = np.eye(4)
    T[:3, :3] = U @ np.diag([1, 1, np.linalg.det(U @ V)]) @ V
    T[:3, 3] = b.mean(0) - T[:3, :3] @ a.mean(0)
    return T


def read(folder, truth=None):
    with open(os.path.join(folder, "health.csv")) as file:
        frames = list(csv.DictReader(file))
    final = {}
    for line in open(os.path.join(folder, "trajectory.txt")):
        if line.strip() and not line.startswith("#"):
            row = line.split()
            final[round(float(row[0]), 5)] = pose(row[1:8])
    names = ["x", "y", "z", "qx", "qy", "qz", "qw"]
    for frame in frames:
        frame["stamp"] = round(float(frame["timestamp"]), 5)
        frame["pose"] = pose([frame[n] for n in names]) if frame["x"] else None
        frame["truth"] = pose([frame["true_" + n] for n in names]) if frame["true_x"] else None
    if truth is not None:
        add_truth(frames, truth)
    if not any(frame["truth"] is not None for frame in frames):
        sys.exit(folder + ": health.csv has no true poses; the source must have them, and the observer writes them with "
                 "truth: true")
    if not with_both(frames):
        sys.exit(folder + ": no frame with a true pose has an estimated one, so that there is nothing to measure")
    return frames, final


def nees_of(frames, final):
    """NEES by frame number."""
    truth = {f["stamp"]: f["truth"] for f in frames}
    result = {}
    for number, f in enumerate(frames):
        if not f["c00"] or not f["reference"] or f["stamp"] not in final or "fallback" in f["reasons"]:
            continue
        reference = round(float(f["reference"]), 5)
        if reference not in final or reference == f["stamp"] or f["state"] == "inertial" or f["truth"] is None \
                or truth.get(reference) is None:
            continue
        C = np.zeros((6, 6))
        for i in range(6):
            for j in range(i, 6):
                C[i, j] = C[j, i] = float(f["c%d%d" % (i, j)])
        true = inverse(truth[reference]) @ f["truth"]
        error = tangent(inverse(true) @ inverse(final[reference]) @ final[f["stamp"]])
        result[number] = error @ np.linalg.solve(C, error)
    return result


def chi_square_quantile(share, degrees):
    """Wilson and Hilferty 1931."""
    z = {0.025: -1.959964, 0.975: 1.959964}[share]
    return degrees * (1 - 2 / (9 * degrees) + z * np.sqrt(2 / (9 * degrees))) ** 3


def alarms_of(frames, by_all=False):
    """Numbers of errors, announced errors, false alarms, those near a loss, frames; the errors that were not announced."""
    T = alignment(frames, by_all)
    times = np.array([f["stamp"] for f in frames])
    big = np.array([f["pose"] is not None and f["truth"] is not None
                    and np.linalg.norm((T @ f["pose"])[:3, 3] - f["truth"][:3, 3]) > BIG for f in frames])
    not_good = np.array([f["state"] not in ("good", "waiting") for f in frames])
    errors, announced, missed, last = 0, 0, [], -np.inf
    for i in np.flatnonzero(big):
        if times[i] - last > BEFORE:
            errors += 1
            if not_good[(times >= times[i] - BEFORE) & (times <= times[i])].any():
                announced += 1
            else:
                missed.append(times[i] - times[0])
        last = times[i]
    false = [i for i in np.flatnonzero(not_good)
             if frames[i]["pose"] is not None and not big[(times >= times[i]) & (times <= times[i] + AFTER)].any()]
    lost = np.array([f["pose"] is None and f["state"] != "waiting" for f in frames])
    near = sum(lost[abs(times - times[i]) <= BEFORE].any() for i in false)
    return errors, announced, len(false), near, len(frames), missed


def main(folders, truth):
    by_frame, everything, totals = {}, [], np.zeros(5, int)
    print("%-32s %6s %8s %8s   %s" % ("recording", "NEES", "errors", "announced", "false alarms"))
    for folder in folders:
        frames, final = read(folder, truth)
        nees = nees_of(frames, final) if truth is None else {}
        for number, value in nees.items():
            by_frame.setdefault(number, []).append(value)
            everything.append(value)
        *counts, missed = alarms_of(frames, truth is not None)
        totals += counts
        mean = np.mean(list(nees.values())) if nees else np.nan
        print("%-32s %6.2f %8d %8d   %d (%d near a loss) of %d%s" % (os.path.basename(os.path.normpath(folder)), mean, *counts, "".join(", missed at %.2f s" % m for m in missed)))
    print("errors above 5 cm: %d, announced %d; false alarms %.2f %% of %d frames, without those near a loss %.2f %%"
          % (totals[0], totals[1], 100 * totals[2] / totals[4], totals[4], 100 * (totals[2] - totals[3]) / totals[4]))
    if not everything:
        sys.exit(0 if truth is not None else "no frame has a covariance and a reference keyframe")
    everything = np.array(everything)
    inside, full = 0, [v for v in by_frame.values() if len(v) >= max(2, len(folders) // 2)]
    for values in full:
        n = len(values)
        inside += chi_square_quantile(0.025, 6 * n) <= sum(values) <= chi_square_quantile(0.975, 6 * n)
    n = len(folders)
    print("NEES: mean %.2f (expected 6; 95 %% band of a mean of %d: %.2f to %.2f), %.1f %% of frames below 12.59 "
          "(expected 95)" % (everything.mean(), n, chi_square_quantile(0.025, 6 * n) / n,
                             chi_square_quantile(0.975, 6 * n) / n, 100 * (everything < 12.592).mean()))
    if full:
        print("mean over recordings of the same frame number: %.1f %% inside the band (expected 95)"
              % (100 * inside / len(full)))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", type=read_truth, metavar="groundtruth.txt", help="trajectory in TUM format")
    parser.add_argument("runs", nargs="+", metavar="RUN", help="folder of a run with the observer health")
    arguments = parser.parse_args()
    main(arguments.runs, arguments.truth)
