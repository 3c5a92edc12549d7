// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/alignment.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "holdfast/core/error.hpp"

namespace holdfast {

std::string_view to_string(AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::se3:
      return "se3";
    case AlignmentKind::sim3:
      return "sim3";
    case AlignmentKind::none:
      return "none";
  }
  return "unknown";
}

std::optional<AlignmentKind> parse_alignment(std::string_view name) {
  for (const AlignmentKind kind : {AlignmentKind::se3, AlignmentKind::sim3, AlignmentKind::none})
    if (name == to_string(kind)) return kind;
  return std::nullopt;
}

TrajectoryAlignment align_positions(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth,
                                    AlignmentKind kind) {
  HOLDFAST_CHECK(estimate.cols() == truth.cols() && estimate.cols() >= 3,
                 "estimate " << estimate.cols() << " truth " << truth.cols());
  TrajectoryAlignment alignment;
  if (kind == AlignmentKind::none) return alignment;
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean();
  const Eigen::Vector3d truth_mean = truth.rowwise().mean();
  const Eigen::Matrix3Xd centred_estimate = estimate.colwise() - estimate_mean;
  const Eigen::Matrix3Xd centred_truth = truth.colwise() - truth_mean;
  const Eigen::Matrix3d covariance = centred_truth * centred_estimate.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  // A reflection may fit better than any rotation; the least singular direction is turned back then.
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
  alignment.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  if (kind == AlignmentKind::sim3) {
    const double spread = centred_estimate.squaredNorm();
    // Equal positions leave rounding errors of the mean behind, hence the comparison with their own size.
    if (!(spread > 1e-24 * estimate.squaredNorm()))
      throw Error(
          "the estimate never moves, so no scale follows from it; expected a moving camera for the alignment sim3, use "
          "se3 for an estimate of metric scale");
    alignment.scale = svd.singularValues().dot(signs) / spread;
  }
  alignment.translation = truth_mean - alignment.scale * (alignment.rotation * estimate_mean);
  return alignment;
}

Eigen::Vector3d TrajectoryAlignment::apply(const Eigen::Vector3d& position) const {
  return scale * (rotation * position) + translation;
}

}  // namespace holdfast
