// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/geometry/se3.hpp"

namespace holdfast::geometry {

/// Residual of a relative pose measurement in a pose graph, and its Jacobians.
struct RelativePoseError {
  Vector6d residual;  ///< log(T_to_from^-1 * T_to_world * T_from_world^-1): translation [m], rotation [rad]
  Matrix6d by_from;   ///< derivative by a left perturbation of T_from_world
  Matrix6d by_to;     ///< derivative by a left perturbation of T_to_world
};

/// The residual alone. `T_from_to` is the inverse of the measurement T_to_from.
inline Vector6d relative_pose_residual(const Eigen::Isometry3d& T_from_to, const Eigen::Isometry3d& T_from_world,
                                       const Eigen::Isometry3d& T_to_world) {
  return log_se3(T_from_to * T_to_world * T_from_world.inverse());
}

/// Residual and derivatives (Sola et al. 2018, equations 175, 179 and 180).
inline RelativePoseError relative_pose_error(const Eigen::Isometry3d& T_from_to, const Eigen::Isometry3d& T_from_world,
                                             const Eigen::Isometry3d& T_to_world) {
  RelativePoseError error;
  error.residual = relative_pose_residual(T_from_to, T_from_world, T_to_world);
  error.by_from = -right_jacobian_inverse_se3(error.residual);
  error.by_to = left_jacobian_inverse_se3(error.residual) * adjoint_se3(T_from_to);
  return error;
}

}  // namespace holdfast::geometry
