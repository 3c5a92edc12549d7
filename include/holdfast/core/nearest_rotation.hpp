// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace holdfast {

/// The rotation that is nearest to a matrix in the Frobenius norm, by its singular value decomposition (Umeyama, PAMI
/// 1991, lemma): of a rotation matrix that was rounded, or of a sum of rotations, whose chordal mean it is.
inline Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d orthogonal = svd.matrixU() * svd.matrixV().transpose();
  if (orthogonal.determinant() > 0.0) return orthogonal;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace holdfast
