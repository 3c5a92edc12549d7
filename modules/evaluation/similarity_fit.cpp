// SPDX-License-Identifier: BSD-3-Clause
#include "similarity_fit.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace holdfast {

SimilarityFit fit_similarity(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth, bool mirrored) {
  SimilarityFit fit;
  if (estimate.cols() == 0) return fit;
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean(), truth_mean = truth.rowwise().mean();
  const Eigen::Matrix3Xd centred_estimate = estimate.colwise() - estimate_mean;
  const Eigen::Matrix3Xd centred_truth = truth.colwise() - truth_mean;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Eigen::Matrix3d(centred_truth * centred_estimate.transpose()),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool is_reflection = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0;
  const Eigen::Vector3d signs(1.0, 1.0, is_reflection == mirrored ? 1.0 : -1.0);
  const double correlation = svd.singularValues().dot(signs);
  const double estimate_spread = centred_estimate.squaredNorm(), truth_spread = centred_truth.squaredNorm();
  fit.scale = estimate_spread > 0.0 ? correlation / estimate_spread : 0.0;
  const auto count = static_cast<double>(estimate.cols());
  const auto rms_at = [&](double scale) {
    const double squares = truth_spread - 2.0 * scale * correlation + scale * scale * estimate_spread;
    return std::sqrt(std::max(squares, 0.0) / count);
  };
  fit.residual = rms_at(fit.scale);
  fit.rigid_residual = rms_at(1.0);
  fit.spread = std::sqrt(truth_spread / count);
  return fit;
}

}  // namespace holdfast
