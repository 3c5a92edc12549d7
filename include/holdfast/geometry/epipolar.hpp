// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "holdfast/core/camera.hpp"
#include "holdfast/geometry/so3.hpp"

/// Two views of the same scene (Hartley and Zisserman, Multiple View Geometry, 2004, chapter 9).
namespace holdfast::geometry {

/// Essential matrix: ray_b^T * E * ray_a = 0 for rays (x, y, 1) in the camera frames (equation 9.12).
inline Eigen::Matrix3d essential_matrix(const Eigen::Isometry3d& T_a_world, const Eigen::Isometry3d& T_b_world) {
  const Eigen::Isometry3d T_b_a = T_b_world * T_a_world.inverse();
  return hat(T_b_a.translation()) * T_b_a.linear();
}

/// Fundamental matrix: pixel_b^T * F * pixel_a = 0 for undistorted pixels (x, y, 1) (equation 9.2).
inline Eigen::Matrix3d fundamental_matrix(const Camera& camera, const Eigen::Isometry3d& T_a_world,
                                          const Eigen::Isometry3d& T_b_world) {
  Eigen::Matrix3d to_ray;
  to_ray << 1.0 / camera.fx, 0, -camera.cx / camera.fx, 0, 1.0 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return to_ray.transpose() * essential_matrix(T_a_world, T_b_world) * to_ray;
}

/// Squared distance of a pixel in b from the epipolar line of a pixel in a [px^2]; infinite where there is no line (the
/// pixel in a is the epipole, or the cameras share their centre).
inline double epipolar_distance2(const Eigen::Matrix3d& fundamental, const Eigen::Vector2d& pixel_a,
                                 const Eigen::Vector2d& pixel_b) {
  const Eigen::Vector3d line = fundamental * pixel_a.homogeneous();
  const double norm2 = line.head<2>().squaredNorm();
  if (!(norm2 > 0.0)) return std::numeric_limits<double>::infinity();
  const double value = line.dot(pixel_b.homogeneous());
  return value * value / norm2;
}

/// Chi-square test at 95 % with one degree of freedom; `sigma2_b`: variance of a pixel coordinate in b [px^2].
inline bool is_on_epipolar_line(const Eigen::Matrix3d& fundamental, const Eigen::Vector2d& pixel_a,
                                const Eigen::Vector2d& pixel_b, double sigma2_b) {
  return epipolar_distance2(fundamental, pixel_a, pixel_b) <= 3.841 * sigma2_b;
}

}  // namespace holdfast::geometry
