// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/geometry/se3.hpp"

namespace holdfast::geometry {

/// Perturbations of a pose that keep its roll and pitch, the direction of the vertical as the camera sees it: four
/// degrees of freedom (Qin, Li and Shen, "VINS-Mono", T-RO 2018, section VIII).
using UprightBasis = Eigen::Matrix<double, 6, 4>;

/// Basis of the left perturbations exp(basis * d) * T_camera_world: d is, to first order, the translation of the camera
/// in the world frame [m], and its turn about the vertical [rad]. Columns are orthonormal. The vertical in the camera
/// frame stays as it is for a d of any size. `vertical`: unit vector in the world frame.
inline UprightBasis upright_basis(const Eigen::Matrix3d& R_camera_world, const Eigen::Vector3d& vertical) {
  UprightBasis basis = UprightBasis::Zero();
  basis.topLeftCorner<3, 3>() = -R_camera_world;
  basis.bottomRightCorner<3, 1>() = -R_camera_world * vertical;
  return basis;
}

}  // namespace holdfast::geometry
