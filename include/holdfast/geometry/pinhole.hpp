// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace holdfast::geometry {

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
  /// The point in the camera frame at a pixel and a depth [m] along the optical axis.
  Eigen::Vector3d back_project(double x, double y, double depth) const {
    return {(x - cx) / fx * depth, (y - cy) / fy * depth, depth};
  }
  /// Column in the right image of a point that the left image shows in column x at a depth [m]: x - fx * baseline /
  /// depth (Mur-Artal and Tardos 2017, section III-A).
  double right_x(double x, double depth) const { return x - fx * baseline / depth; }
};

/// Reads the intrinsics of a caller's camera type. The default takes the members fx, fy, cx, cy and, where there is
/// one, baseline. Specialise it for a camera that stores them otherwise.
template <class Camera>
struct CameraTraits {
  static Pinhole pinhole(const Camera& camera) {
    Pinhole result{camera.fx, camera.fy, camera.cx, camera.cy, 0.0};
    if constexpr (requires { camera.baseline; }) result.baseline = camera.baseline;
    return result;
  }
};

/// Intrinsics of any camera type with CameraTraits.
template <class Camera>
Pinhole pinhole_of(const Camera& camera) {
  return CameraTraits<Camera>::pinhole(camera);
}

}  // namespace holdfast::geometry
