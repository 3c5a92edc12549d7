// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace holdfast {

/// Nearest rotation to a matrix in the Frobenius norm, by singular value decomposition (Umeyama, PAMI 1991, lemma).
/// Orthonormalises a rounded rotation matrix; for a sum of rotations it is their chordal L2 mean.
inline Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d orthogonal = svd.matrixU() * svd.matrixV().transpose();
  if (orthogonal.determinant() > 0.0) return orthogonal;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace holdfast
