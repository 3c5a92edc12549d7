#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The measurements of synthesise_imu.py are those of the motion that the poses were taken from."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; Debian's python3-numpy has it")
    sys.exit(0)

TOOL = pathlib.Path(sys.argv.pop(1)) / "synthesise_imu.py"
RADIUS, SPEED = 0.5, 1.2  # of a circle [m], [rad/s]
GRAVITY = 9.80665


def measurements(*options, noise=0.0, gap=False):
    """Of a body on a circle, which turns about the vertical as fast as it goes round, with x pointing outwards."""
    with tempfile.TemporaryDirectory() as folder:
        lines = ["# a comment\n"]
        random = np.random.default_rng(1)
        for i in range(1000):
            if gap and 400 <= i < 450:
                continue
            t, angle = 100 + 0.01 * i, SPEED * 0.01 * i
            x, y, z = RADIUS * np.cos(angle), RADIUS * np.sin(angle), 1.0
            x, y, z = (value + random.normal(0, noise) for value in (x, y, z))
            sign = -1 if i % 2 else 1  # both are the same rotation
            lines.append(f"{t} {x} {y} {z} 0 0 {sign * np.sin(angle / 2)} {sign * np.cos(angle / 2)}\n")
        (pathlib.Path(folder) / "groundtruth.txt").write_text("".join(lines))
        done = subprocess.run([sys.executable, str(TOOL), folder, *options], check=True, capture_output=True, text=True)
        return np.loadtxt(pathlib.Path(folder) / "imu.csv", delimiter=","), done.stdout


class SynthesiseImu(unittest.TestCase):
    def test_a_circle_has_its_rate_and_its_force(self):
        rows, text = measurements("--sensor", "none")
        self.assertIn("residual of the spline 0.00 mm", text)
        self.assertAlmostEqual(rows[1, 0] - rows[0, 0], 0.005, 9)
        middle = rows[100:-100]
        np.testing.assert_allclose(middle[:, 1:4], np.tile([0, 0, SPEED], (len(middle), 1)), atol=2e-3)
        np.testing.assert_allclose(middle[:, 4:7], np.tile([-RADIUS * SPEED**2, 0, GRAVITY], (len(middle), 1)), atol=2e-2)

    def test_noise_of_the_poses_is_smoothed(self):
        rows, _ = measurements("--sensor", "none", noise=1e-3)
        force = rows[100:-100, 4:7] - [-RADIUS * SPEED**2, 0, GRAVITY]
        self.assertLess(np.sqrt(np.mean(force**2)), 1.0, "differences of the poses would give 24")

    def test_noise_is_that_of_the_sensor_and_of_the_seed(self):
        exact, _ = measurements("--sensor", "none")
        first, text = measurements("--sensor", "adis16448", "--seed", "5")
        self.assertIn("imu: adis16448", text)
        np.testing.assert_array_equal(first, measurements("--sensor", "adis16448", "--seed", "5")[0])
        difference = first - exact
        self.assertAlmostEqual(np.std(np.diff(difference[:, 1])) / np.sqrt(2), 1.6968e-4 * np.sqrt(200), 4)
        self.assertAlmostEqual(np.std(np.diff(difference[:, 4])) / np.sqrt(2), 2.0e-3 * np.sqrt(200), 2)
        self.assertGreater(np.max(np.abs(np.mean(difference[:, 4:7], axis=0))), 0.01, "a bias")

    def test_a_gap_is_named(self):
        self.assertIn("no poses for 0.51 s from 103.990", measurements(gap=True)[1])


if __name__ == "__main__":
    unittest.main()
