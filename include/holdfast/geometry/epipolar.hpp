// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "holdfast/geometry/pinhole.hpp"
#include "holdfast/geometry/so3.hpp"

/// Two views of the same scene (Hartley and Zisserman, Multiple View Geometry, 2004, chapter 9).
namespace holdfast::geometry {

/// Essential matrix: ray_b^T * E * ray_a = 0 for rays (x, y, 1) in the camera frames (equation 9.12).
inline Eigen::Matrix3d essential_matrix(const Eigen::Isometry3d& T_a_world, const Eigen::Isometry3d& T_b_world) {
  const Eigen::Isometry3d T_b_a = T_b_world * T_a_world.inverse();
  return hat(T_b_a.translation()) * T_b_a.linear();
}

/// Fundamental matrix: pixel_b^T * F * pixel_a = 0 for undistorted pixels (x, y, 1) (equation 9.2). Any camera type
/// with CameraTraits.
template <class Camera>
Eigen::Matrix3d fundamental_matrix(const Camera& camera_model, const Eigen::Isometry3d& T_a_world,
                                   const Eigen::Isometry3d& T_b_world) {
  const Pinhole camera = pinhole_of(camera_model);
  Eigen::Matrix3d to_ray;
  to_ray << 1.0 / camera.fx, 0, -camera.cx / camera.fx, 0, 1.0 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return to_ray.transpose() * essential_matrix(T_a_world, T_b_world) * to_ray;
}

/// Epipolar line in image b of a pixel in image a: a * x + b * y + c = 0.
struct EpipolarLine {
  double a = 0.0, b = 0.0, c = 0.0;

  /// Squared distance of a pixel from the line [px^2]; infinite if the line is undefined (the pixel in a is the
  /// epipole, or the camera centres coincide).
  double distance2(double x, double y) const {
    const double norm2 = a * a + b * b, value = a * x + b * y + c;
    return norm2 > 0.0 ? value * value / norm2 : std::numeric_limits<double>::infinity();
  }
  /// Whether the squared distance is at most `limit` variances of a pixel coordinate; `inverse_sigma2` [1/px^2]. Needs
  /// no division. False if the line is undefined.
  bool is_near(double x, double y, double inverse_sigma2, double limit = 3.841) const {
    const double norm2 = a * a + b * b, value = a * x + b * y + c;
    return norm2 > 0.0 && value * value * inverse_sigma2 <= limit * norm2;
  }
};

/// The epipolar line of a pixel of image a.
inline EpipolarLine epipolar_line(const Eigen::Matrix3d& fundamental, const Eigen::Vector2d& pixel_a) {
  const Eigen::Vector3d line = fundamental * pixel_a.homogeneous();
  return {line.x(), line.y(), line.z()};
}

}  // namespace holdfast::geometry
