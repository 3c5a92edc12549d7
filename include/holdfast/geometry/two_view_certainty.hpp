// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "holdfast/geometry/pinhole.hpp"
#include "holdfast/geometry/so3.hpp"
#include "holdfast/geometry/two_view_motion.hpp"

namespace holdfast::geometry {

/// Standard deviation of the direction of translation between two views [rad], to first order: that of a motion which
/// minimises the Sampson distances of the pairs (Hartley and Zisserman, section 11.4.3), so that the unknown depth of
/// every point is accounted for. It is large where the pairs cover a small part of the image, since rotation and
/// translation move them alike, and where parallax is small. Infinite for fewer than five pairs or where the direction
/// is undetermined. `T_b_a` maps points of camera a to camera b; the length of its translation does not matter. Any
/// camera type with CameraTraits.
template <class Camera>
double direction_deviation(const Camera& camera_model, std::span<const PixelPair> pairs,
                           const Eigen::Isometry3d& T_b_a) {
  constexpr double undetermined = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d direction = T_b_a.translation().normalized();
  if (pairs.size() < 5 || !direction.allFinite()) return undetermined;
  const Pinhole camera = pinhole_of(camera_model);
  const auto ray = [&](const Eigen::Vector2d& pixel) { return camera.back_project(pixel.x(), pixel.y(), 1.0); };
  const Eigen::Vector3d first = direction.unitOrthogonal(), second = direction.cross(first);
  const auto essential = [&](const Eigen::Matrix<double, 5, 1>& change) -> Eigen::Matrix3d {
    const Eigen::Vector3d moved = (direction + change[3] * first + change[4] * second).normalized();
    return hat(moved) * exp_so3(change.head<3>()) * T_b_a.linear();
  };
  constexpr double step = 1e-6;
  std::array<Eigen::Matrix3d, 5> derivative;
  for (int k = 0; k < 5; ++k) {
    Eigen::Matrix<double, 5, 1> change = Eigen::Matrix<double, 5, 1>::Zero();
    change[k] = step;
    derivative[static_cast<std::size_t>(k)] = (essential(change) - essential(-change)) / (2.0 * step);
  }
  const Eigen::Matrix3d at = essential(Eigen::Matrix<double, 5, 1>::Zero());
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  for (const PixelPair& pair : pairs) {
    const Eigen::Vector3d a = ray(pair.a), b = ray(pair.b);
    const Eigen::Vector3d in_b = at * a, in_a = at.transpose() * b;
    const double variance = pair.sigma2_b * (std::pow(in_b.x() / camera.fx, 2) + std::pow(in_b.y() / camera.fy, 2)) +
                            pair.sigma2_a * (std::pow(in_a.x() / camera.fx, 2) + std::pow(in_a.y() / camera.fy, 2));
    if (!(variance > 0.0)) continue;
    Eigen::Matrix<double, 5, 1> jacobian;
    for (int k = 0; k < 5; ++k) jacobian[k] = b.dot(derivative[static_cast<std::size_t>(k)] * a);
    information += jacobian * jacobian.transpose() / variance;
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 5, 5>> solver(information);
  if (!solver.isInvertible()) return undetermined;
  const Eigen::Matrix<double, 5, 5> covariance = solver.inverse();
  const double variance = covariance(3, 3) + covariance(4, 4);
  return variance > 0.0 ? std::sqrt(variance) : undetermined;
}

}  // namespace holdfast::geometry
