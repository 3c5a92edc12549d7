#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which pixels ignore_box.py leaves out: those that show the inside of the box, and no others."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import cv2
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; Debian's python3-numpy and python3-opencv have it")
    sys.exit(0)

TOOL = pathlib.Path(sys.argv.pop(1)) / "ignore_box.py"
BOX = ["-0.5", "0.5", "-0.5", "0.5", "1.5", "2.5"]  # two metres before a camera at the origin that looks along z
CENTRE, OUTSIDE = (248, 320), (20, 20)  # row, column


def labels_of(depth, rotation="0 0 0 1", margin=4):
    """Labels of one image, whose depth [m] is given."""
    with tempfile.TemporaryDirectory() as folder:
        sequence = pathlib.Path(folder)
        for name in ("rgb", "depth"):
            (sequence / name).mkdir()
            (sequence / f"{name}.txt").write_text(f"1.0 {name}/1.0.png\n")
        cv2.imwrite(str(sequence / "rgb/1.0.png"), np.zeros((480, 640, 3), np.uint8))
        cv2.imwrite(str(sequence / "depth/1.0.png"), np.round(depth * 5000).astype(np.uint16))
        (sequence / "groundtruth.txt").write_text(f"0.5 0 0 0 {rotation}\n1.5 0 0 0 {rotation}\n")
        command = [sys.executable, str(TOOL), str(sequence), str(sequence / "labels"), "--camera", "fr3", "--margin",
                   str(margin), "--box", *BOX]
        subprocess.run(command, check=True, capture_output=True)
        return cv2.imread(str(sequence / "labels/1.0.png"), cv2.IMREAD_UNCHANGED)


class IgnoreBox(unittest.TestCase):
    def test_what_stands_in_the_box_is_unknown(self):
        labels = labels_of(np.full((480, 640), 2.0))
        self.assertEqual(set(np.unique(labels)), {0, 255})
        self.assertEqual((labels[CENTRE], labels[OUTSIDE]), (255, 0))
        side = 535.4 / 2.0  # pixels of a metre at two metres
        self.assertAlmostEqual((labels == 255).sum() / (side + 8) ** 2, 1.0, delta=0.03)

    def test_what_stands_before_or_behind_it_counts(self):
        for metres in (1.0, 4.0):
            self.assertEqual(np.count_nonzero(labels_of(np.full((480, 640), metres))), 0)

    def test_pixels_without_depth_are_unknown_where_the_box_is(self):
        labels = labels_of(np.zeros((480, 640)))
        self.assertEqual((labels[CENTRE], labels[OUTSIDE]), (255, 0))

    def test_a_camera_that_looks_away_sees_nothing_of_it(self):
        self.assertEqual(np.count_nonzero(labels_of(np.zeros((480, 640)), rotation="0 1 0 0")), 0)


if __name__ == "__main__":
    unittest.main()
