// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace holdfast {

/// Intrinsics of a pinhole camera without lens distortion, and the baseline of its real or virtual stereo pair. Camera
/// frame: x right, y down, z forward [m]. Pixel centres lie at integer coordinates.
struct Pinhole {
  double fx = 1.0, fy = 1.0;  ///< focal lengths [px]
  double cx = 0.0, cy = 0.0;  ///< principal point [px]
  double baseline = 0.0;      ///< [m]; used by observations with a column in the right image

  /// Pixel of a point in the camera frame; z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    const double inverse_z = 1.0 / point.z();
    return {fx * point.x() * inverse_z + cx, fy * point.y() * inverse_z + cy};
  }
  /// Position of a pixel in the plane z = 1.
  Eigen::Vector2d normalised(double x, double y) const { return {(x - cx) / fx, (y - cy) / fy}; }
  /// The point in the camera frame at a pixel and a depth [m] along the optical axis.
  Eigen::Vector3d back_project(double x, double y, double depth) const {
    const Eigen::Vector2d at = normalised(x, y);
    return {at.x() * depth, at.y() * depth, depth};
  }
  /// Column in the right image of a point that the left image shows in column x at a depth [m]: x - fx * baseline /
  /// depth (Mur-Artal and Tardos 2017, section III-A).
  double right_x(double x, double depth) const { return x - fx * baseline / depth; }
};

}  // namespace holdfast
