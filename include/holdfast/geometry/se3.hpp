// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/geometry/so3.hpp"

/// Rigid motions and their tangent space, after Sola, Deray and Atchuthan 2018, appendix D. A tangent vector is
/// (translation part [m], rotation part [rad]), in this order in every function.
namespace holdfast::geometry {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Exponential map (equation 172).
inline Eigen::Isometry3d exp_se3(const Vector6d& tangent) {
  const Eigen::Vector3d rotation = tangent.tail<3>();
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = exp_so3(rotation).toRotationMatrix();
  result.translation() = left_jacobian_so3(rotation) * tangent.head<3>();
  return result;
}

/// Logarithm, with a rotation angle of at most pi (equation 173).
inline Vector6d log_se3(const Eigen::Isometry3d& motion) {
  Vector6d result;
  result.tail<3>() = log_so3(Eigen::Matrix3d(motion.linear()));
  result.head<3>() = left_jacobian_inverse_so3(result.tail<3>()) * motion.translation();
  return result;
}

/// True if the translation is longer than `distance` [m] or the rotation angle larger than `angle` [rad].
inline bool exceeds(const Eigen::Isometry3d& motion, double distance, double angle) {
  return motion.translation().norm() > distance || Eigen::AngleAxisd(motion.linear()).angle() > angle;
}

/// Adjoint matrix: motion * exp(d) = exp(adjoint * d) * motion (equation 175).
inline Matrix6d adjoint_se3(const Eigen::Isometry3d& motion) {
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = motion.linear();
  result.bottomRightCorner<3, 3>() = motion.linear();
  result.topRightCorner<3, 3>() = hat(motion.translation()) * motion.linear();
  return result;
}

/// The upper right block of the left Jacobian (equation 180, after Barfoot and Furgale 2014).
inline Eigen::Matrix3d left_jacobian_coupling(const Vector6d& tangent) {
  const Eigen::Matrix3d r = hat(tangent.head<3>());
  const Eigen::Matrix3d p = hat(tangent.tail<3>());
  const double angle2 = tangent.tail<3>().squaredNorm();
  const double angle = std::sqrt(angle2);
  double a, b, c;
  if (angle < 0.3) {  // the closed forms lose digits to cancellation here
    a = 1.0 / 6 - angle2 * (1.0 / 120 - angle2 * (1.0 / 5040 - angle2 / 362880));
    b = 1.0 / 24 - angle2 * (1.0 / 720 - angle2 * (1.0 / 40320 - angle2 / 3628800));
    c = 1.0 / 120 - angle2 * (1.0 / 2520 - angle2 * (1.0 / 120960 - angle2 / 9979200));
  } else {
    const double sine = std::sin(angle), cosine = std::cos(angle);
    a = (angle - sine) / (angle2 * angle);
    b = (angle2 + 2.0 * cosine - 2.0) / (2.0 * angle2 * angle2);
    c = (2.0 * angle - 3.0 * sine + angle * cosine) / (2.0 * angle2 * angle2 * angle);
  }
  const Eigen::Matrix3d pr = p * r, rp = r * p, prp = pr * p;
  return 0.5 * r + a * (pr + rp + prp) + b * (p * pr + rp * p - 3.0 * prp) + c * (prp * p + p * prp);
}

/// Inverse of the left Jacobian J, for which exp(tangent + d) = exp(J * d) * exp(tangent) to first order in d
/// (equations 179a and 179b).
inline Matrix6d left_jacobian_inverse_se3(const Vector6d& tangent) {
  const Eigen::Matrix3d inverse = left_jacobian_inverse_so3(tangent.tail<3>());
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = inverse;
  result.bottomRightCorner<3, 3>() = inverse;
  result.topRightCorner<3, 3>() = -inverse * left_jacobian_coupling(tangent) * inverse;
  return result;
}

/// Inverse of the right Jacobian J, for which exp(tangent + d) = exp(tangent) * exp(J * d) to first order in d.
inline Matrix6d right_jacobian_inverse_se3(const Vector6d& tangent) { return left_jacobian_inverse_se3(-tangent); }

/// Normalises the rotation, which removes rounding errors accumulated by a product of many motions.
inline Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& motion) {
  Eigen::Isometry3d result = motion;
  result.linear() = Eigen::Quaterniond(motion.linear()).normalized().toRotationMatrix();
  return result;
}

}  // namespace holdfast::geometry
