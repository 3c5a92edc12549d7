#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Inertial measurements for a real recording, from its motion capture.

Reads groundtruth.txt of a TUM-layout sequence and writes imu.csv, which the sources `tum` and `folder` read: the angular
velocity and the specific force of a smoothing spline through the poses (cubic B-splines of the components of position
and quaternion, with a penalty on the change of their third derivative), in the axes of the camera, with the white noise and the walking
biases of a chosen sensor.  The camera is the body: T_body_camera is the identity.  Images, poses and lists stay as they
are.  The same seed gives the same file.

Motion that is faster than two knots is lost: the residual of the spline, which is printed, should be that of the motion
capture.  Where poses are missing the motion is invented; such gaps are printed.

Example
  synthesise_imu.py rgbd_dataset_freiburg1_rpy --sensor bmi055 --seed 1
  holdfast dataset check rgbd_dataset_freiburg1_rpy

Needs: Debian's python3 with python3-numpy.
"""
import argparse
import os
import sys

import numpy as np

HEADER = "# timestamp [s], angular velocity x y z [rad/s], specific force x y z [m/s^2], in the body frame\n"
GRAVITY = 9.80665
SENSORS = {  # noise densities of gyroscope and accelerometer, random walks of both: those of the section `imu`
    "none": (0.0, 0.0, 0.0, 0.0),
    "adis16448": (1.6968e-4, 2.0e-3, 1.9393e-5, 3.0e-3),
    "bmi055": (4.887e-4, 2.942e-3, 2e-5, 1e-3),
    "bmi085": (4.887e-4, 2.354e-3, 2e-5, 1e-3),
    "bmi160": (1.6e-4, 2.8e-3, 2.2e-5, 8.6e-4),
}
INITIAL_BIAS = (0.01, 0.1)  # deviation, of gyroscope [rad/s] and accelerometer [m/s^2]


def read_poses(path):
    """Time stamps, positions, and quaternions (x y z w) without jumps of their sign."""
    with open(path, encoding="utf-8") as file:
        rows = np.array([[float(word) for word in line.split()[:8]] for line in file
                         if line.strip() and not line.startswith("#")])
    if len(rows) < 8:
        sys.exit(f"{path}: holds {len(rows)} poses; expected motion capture")
    rows = rows[np.concatenate([[True], np.diff(rows[:, 0]) > 0])]
    quaternions = rows[:, 4:8] / np.linalg.norm(rows[:, 4:8], axis=1, keepdims=True)
    for i in range(1, len(quaternions)):
        if np.dot(quaternions[i], quaternions[i - 1]) < 0:
            quaternions[i] *= -1
    return rows[:, 0], rows[:, 1:4], quaternions


def weights(share, derivative):
    """Weights of the four control points of a uniform cubic B-spline, with knots 1 apart."""
    u, one = share, np.ones_like(share)
    return np.stack({
        0: [(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4 * one, -3 * u**3 + 3 * u**2 + 3 * u + one, u**3],
        1: [-3 * (1 - u) ** 2, 9 * u**2 - 12 * u, -9 * u**2 + 6 * u + 3 * one, 3 * u**2],
        2: [6 * (1 - u), 18 * u - 12 * one, -18 * u + 6 * one, 6 * u],
    }[derivative], axis=1) / 6.0


class Spline:
    """Cubic smoothing spline of several components (de Boor 1978, chapter XIV)."""

    def __init__(self, times, values, spacing, smoothing):
        self.start, self.spacing = times[0], spacing
        count = int(np.ceil((times[-1] - times[0]) / spacing)) + 4
        bands = np.zeros((4, count))  # of the symmetric normal equations: bands[k, i] = element (i, i + k)
        right = np.zeros((count, values.shape[1]))
        first, share = self.place(times)
        w = weights(share, 0)
        for a in range(4):
            np.add.at(right, first + a, w[:, a:a + 1] * values)
            for b in range(a, 4):
                np.add.at(bands[b - a], first + a, w[:, a] * w[:, b])
        penalty = np.array([-1.0, 3.0, -3.0, 1.0])  # third differences
        for a in range(4):
            for b in range(a, 4):
                bands[b - a, a:count - 3 + a] += smoothing * penalty[a] * penalty[b]
        self.control = solve_banded(bands, right)

    def place(self, times):
        position = (np.asarray(times) - self.start) / self.spacing
        first = np.floor(position).astype(int)
        return first, position - first

    def at(self, times, derivative=0):
        first, share = self.place(times)
        w = weights(share, derivative) / self.spacing**derivative
        return sum(w[:, a:a + 1] * self.control[first + a] for a in range(4))


def solve_banded(bands, right):
    """Solves a symmetric positive definite system with three bands beside the diagonal, by Cholesky's method."""
    width, count = bands.shape
    lower = np.zeros((count, width))  # lower[i, k] = element (i, i - k)
    for i in range(count):
        for k in range(min(i, width - 1), -1, -1):
            j = i - k
            common = range(max(i - width + 1, j - width + 1, 0), j)
            value = bands[k, j] - sum(lower[i, i - m] * lower[j, j - m] for m in common)
            lower[i, k] = np.sqrt(value) if k == 0 else value / lower[j, 0]
    result = right.copy()
    for i in range(count):
        for k in range(1, min(i, width - 1) + 1):
            result[i] -= lower[i, k] * result[i - k]
        result[i] /= lower[i, 0]
    for i in range(count - 1, -1, -1):
        for k in range(1, min(count - 1 - i, width - 1) + 1):
            result[i] -= lower[i + k, k] * result[i + k]
        result[i] /= lower[i, 0]
    return result


def rotation_matrices(q):
    x, y, z, w = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=1)], axis=1)


def exact_measurements(position, rotation, times):
    """Angular velocities and specific forces of the splines."""
    q, change = rotation.at(times), rotation.at(times, 1)
    norm = np.linalg.norm(q, axis=1, keepdims=True)
    q, change = q / norm, change / norm  # the part along q does not count below
    v, w = q[:, :3], q[:, 3:]
    dv, dw = change[:, :3], change[:, 3:]
    rates = 2.0 * (w * dv - dw * v - np.cross(v, dv))  # the vector of 2 conj(q) dq
    force = position.at(times, 2) + np.array([0.0, 0.0, GRAVITY])
    return rates, np.einsum("nij,ni->nj", rotation_matrices(q), force)


def disturbed(rates, forces, noise, rate, random):
    """With white noise and walking biases (Furgale, Rehder and Siegwart 2013)."""
    if not any(noise):
        return rates, forces
    shape, result = rates.shape, []
    for values, density, walk, bias in zip((rates, forces), noise[:2], noise[2:], INITIAL_BIAS):
        biases = random.normal(0.0, bias, 3) + np.cumsum(random.normal(0.0, walk / np.sqrt(rate), shape), axis=0)
        result.append(values + biases + random.normal(0.0, density * np.sqrt(rate), shape))
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", help="folder with groundtruth.txt, whose world has z upwards")
    parser.add_argument("--output", help="file to write [imu.csv in the folder]")
    parser.add_argument("--sensor", choices=SENSORS, default="bmi055")
    parser.add_argument("--rate", type=float, default=200.0, help="measurements per second [200]")
    parser.add_argument("--knots", type=float, default=0.05, help="distance of the spline's knots [0.05 s]")
    parser.add_argument("--smoothing", type=float, default=0.02, help="weight of the penalty [0.02]")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if min(options.rate, options.knots, options.smoothing) <= 0:
        parser.error("--rate, --knots and --smoothing are positive")
    times, positions, quaternions = read_poses(os.path.join(options.sequence, "groundtruth.txt"))
    position = Spline(times, positions, options.knots, options.smoothing)
    rotation = Spline(times, quaternions, options.knots, options.smoothing)
    stamps = times[0] + np.arange(int((times[-1] - times[0]) * options.rate)) / options.rate
    rates, forces = exact_measurements(position, rotation, stamps)
    rates, forces = disturbed(rates, forces, SENSORS[options.sensor], options.rate, np.random.default_rng(options.seed))
    output = options.output or os.path.join(options.sequence, "imu.csv")
    with open(output, "w", encoding="utf-8") as file:
        file.write(HEADER)
        for stamp, rate, force in zip(stamps, rates, forces):
            file.write(f"{stamp:.6f}," + ",".join(f"{value:.9g}" for value in (*rate, *force)) + "\n")
    fitted = rotation.at(times)
    cosine = np.abs(np.sum(fitted * quaternions, axis=1)) / np.linalg.norm(fitted, axis=1)
    print(f"{len(stamps)} measurements written to {output}; residual of the spline "
          f"{1e3 * np.sqrt(np.mean(np.sum((position.at(times) - positions) ** 2, axis=1))):.2f} mm, "
          f"{np.degrees(np.sqrt(np.mean((2 * np.arccos(np.minimum(cosine, 1.0))) ** 2))):.3f} degrees")
    for i in np.flatnonzero(np.diff(times) > 3 * options.knots):
        print(f"no poses for {times[i + 1] - times[i]:.2f} s from {times[i]:.3f}: the motion there is invented")
    if options.sensor != "none":
        print(f"add to the configuration: imu: {options.sensor}")


if __name__ == "__main__":
    main()
