#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Label images for a recording in which nobody moves but somebody sits: what a segmenter finds there does not count.

Reads a TUM-layout sequence (rgb.txt, depth.txt, groundtruth.txt) and a box of its world, and writes labels/STAMP.png for
every n-th colour image: 0, and 255 (unknown) where the image shows the inside of the box: the pixels of its projection
whose depth lies in it or is missing, and a margin for the edges of depth.  What stands before the box counts.

The man at the desk of freiburg1_xyz and freiburg1_rpy, whose world frames are the same, sits in
  --box -1.35 -0.45 0.2 1.15 0.1 1.6

Example
  ignore_box.py rgbd_dataset_freiburg1_rpy out/labels --every 6 --box -1.35 -0.45 0.2 1.15 0.1 1.6
  holdfast evaluate-segmentation rgbd.yaml --set segmenter=unet --images rgbd_dataset_freiburg1_rpy/rgb --labels out/labels \\
    --label-map '{255: unknown, 1: person}'

Needs: Debian's python3 with python3-numpy and python3-opencv.
"""
import argparse
import os

import cv2
import numpy as np

from compose_people import CAMERAS, Trajectory, read_list

NEAR = 0.1  # of the camera, where projections end [m]


def corners(box):
    low, high = np.array(box[0::2]), np.array(box[1::2])
    return np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])


def edge_points(box, count=200):
    """Points along the twelve edges of the box."""
    points = corners(box)
    share = np.linspace(0.0, 1.0, count)[:, None]
    pairs = [(i, i | 1 << k) for i in range(8) for k in range(3) if not i >> k & 1]
    return np.concatenate([points[i] * (1 - share) + points[j] * share for i, j in pairs])


def projection(box, pose, camera, shape):
    """1 inside the outline of the box in the image."""
    rotation, position = pose
    points = (edge_points(box) - position) @ rotation
    points = points[points[:, 2] > NEAR]
    inside = np.zeros(shape, np.uint8)
    if len(points) < 3:
        return inside
    # Far outside the image the lens polynomial turns back: such directions are drawn without it, at the same side.
    matrix, distortion = camera
    plain = points[:, :2] / points[:, 2:]
    within = np.hypot(*plain.T) < 1.0
    pixels = plain @ matrix[:2, :2].T + matrix[:2, 2]
    if within.any():
        pixels[within] = cv2.projectPoints(points[within], np.zeros(3), np.zeros(3), matrix, distortion)[0].reshape(-1, 2)
    hull = cv2.convexHull(np.clip(pixels, -30000, 30000).astype(np.int32))
    cv2.fillConvexPoly(inside, hull, 1)
    return inside


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence")
    parser.add_argument("output")
    parser.add_argument("--box", type=float, nargs=6, required=True, metavar=("X0", "X1", "Y0", "Y1", "Z0", "Z1"))
    parser.add_argument("--camera", default="fr1", choices=CAMERAS)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--margin", type=int, default=12, help="around the pixels of the box [px] (default: 12)")
    parser.add_argument("--depth-units", type=float, default=5000.0)
    arguments = parser.parse_args()

    fx, fy, cx, cy, distortion = CAMERAS[arguments.camera]
    camera = (np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]]), np.array(distortion, float))
    truth = Trajectory(os.path.join(arguments.sequence, "groundtruth.txt"))
    depth_rows = read_list(os.path.join(arguments.sequence, "depth.txt"))
    depth_times = np.array([float(row[0]) for row in depth_rows])
    low, high = np.array(arguments.box[0::2]), np.array(arguments.box[1::2])
    os.makedirs(arguments.output, exist_ok=True)
    written, ignored, rays = 0, 0.0, None
    for stamp, path in read_list(os.path.join(arguments.sequence, "rgb.txt"))[::arguments.every]:
        pose = truth.at(float(stamp))
        if pose is None:
            continue
        nearest = int(np.argmin(abs(depth_times - float(stamp))))
        depth = cv2.imread(os.path.join(arguments.sequence, depth_rows[nearest][1]), cv2.IMREAD_UNCHANGED)
        depth = depth.astype(np.float32) / arguments.depth_units
        if rays is None:
            grid = np.stack(np.meshgrid(np.arange(depth.shape[1]), np.arange(depth.shape[0])), -1).astype(np.float64)
            rays = cv2.undistortPoints(grid.reshape(-1, 1, 2), *camera).reshape(*depth.shape, 2)
            rays = np.dstack([rays, np.ones(depth.shape)])
        points = (rays * depth[..., None]) @ pose[0].T + pose[1]
        within = (depth > 0) & np.all((points > low) & (points < high), axis=2)
        unsure = (within | (depth == 0)) & (projection(arguments.box, pose, camera, depth.shape) > 0)
        kernel = np.ones((2 * arguments.margin + 1,) * 2, np.uint8)
        labels = np.where(cv2.dilate(unsure.astype(np.uint8), kernel) > 0, 255, 0).astype(np.uint8)
        name = os.path.splitext(os.path.basename(path))[0]
        cv2.imwrite(os.path.join(arguments.output, f"{name}.png"), labels)
        written, ignored = written + 1, ignored + float((labels > 0).mean())
    print(f"{written} images, {100 * ignored / max(written, 1):.1f} % of their pixels ignored")


if __name__ == "__main__":
    main()
