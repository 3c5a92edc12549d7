// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace holdfast {

/// Residuals of the best alignment of an estimate with the ground truth (Umeyama 1991), without the alignment itself.
struct SimilarityFit {
  double scale = 1.0;           ///< of the best similarity
  double residual = 0.0;        ///< RMSE after the best similarity [m]
  double rigid_residual = 0.0;  ///< RMSE after the best rigid motion, with the scale 1 [m]
  double spread = 0.0;          ///< RMS distance of the true positions from their mean [m]

  /// Share of the true motion that the similarity does not explain: 0 for a perfect estimate, 1 for an unrelated one.
  double relative() const { return spread > 0.0 ? residual / spread : 1.0; }
};

/// Fits corresponding positions, one per column. `mirrored` uses a reflection in place of a rotation.
SimilarityFit fit_similarity(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth, bool mirrored = false);

}  // namespace holdfast
