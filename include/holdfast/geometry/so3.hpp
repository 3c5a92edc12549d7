// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>

/// Rotations and their tangent space, after Sola, Deray and Atchuthan, "A micro Lie theory for state estimation in
/// robotics", 2018, appendix B. A tangent vector is axis times angle [rad]. Exact to rounding for small angles too.
namespace holdfast::geometry {

/// The matrix of the cross product: hat(a) * b = a x b.
inline Eigen::Matrix3d hat(const Eigen::Vector3d& vector) {
  Eigen::Matrix3d result;
  result << 0, -vector.z(), vector.y(), vector.z(), 0, -vector.x(), -vector.y(), vector.x(), 0;
  return result;
}

/// Exponential map: unit quaternion of a rotation vector (equation 132).
inline Eigen::Quaterniond exp_so3(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  // sin(angle / 2) / angle; the series' next term is below rounding there.
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), scale * rotation.x(), scale * rotation.y(), scale * rotation.z());
}

/// Logarithm: rotation vector with an angle of at most pi. Computed from the half angle, which is accurate near pi.
inline Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double cosine = sign * rotation.w();
  if (sine < 1e-8) return sign * 2.0 / cosine * rotation.vec();
  return sign * 2.0 * std::atan2(sine, cosine) / sine * rotation.vec();
}
inline Eigen::Vector3d log_so3(const Eigen::Matrix3d& rotation) { return log_so3(Eigen::Quaterniond(rotation)); }

/// Left Jacobian: exp(rotation + d) = exp(left_jacobian * d) * exp(rotation) to first order in d (equation 145).
inline Eigen::Matrix3d left_jacobian_so3(const Eigen::Vector3d& rotation) {
  const double angle2 = rotation.squaredNorm();
  const double angle = std::sqrt(angle2);
  double a, b;  // (1 - cos) / angle^2 and (angle - sin) / angle^3
  if (angle < 0.1) {
    a = 0.5 - angle2 * (1.0 / 24 - angle2 * (1.0 / 720 - angle2 / 40320));
    b = 1.0 / 6 - angle2 * (1.0 / 120 - angle2 * (1.0 / 5040 - angle2 / 362880));
  } else {
    a = (1.0 - std::cos(angle)) / angle2;
    b = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Eigen::Matrix3d cross = hat(rotation);
  return Eigen::Matrix3d::Identity() + a * cross + b * cross * cross;
}

/// Inverse of left_jacobian_so3 (equation 146); finite up to and including pi.
inline Eigen::Matrix3d left_jacobian_inverse_so3(const Eigen::Vector3d& rotation) {
  const double angle2 = rotation.squaredNorm();
  const double half = 0.5 * std::sqrt(angle2);
  const double scale =
      half < 0.05 ? 1.0 / 12 + angle2 * (1.0 / 720 + angle2 / 30240) : (1.0 - half / std::tan(half)) / angle2;
  const Eigen::Matrix3d cross = hat(rotation);
  return Eigen::Matrix3d::Identity() - 0.5 * cross + scale * cross * cross;
}

}  // namespace holdfast::geometry
