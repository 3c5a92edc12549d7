// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/interfaces/optimizer.hpp"

/// Selection of the observations, points and poses of a bundle adjustment, and outlier classification at its end;
/// shared by all optimizers.
namespace holdfast {

/// Outlier thresholds of the squared residual over its variance, without (two) and with (three) a column in the right
/// image. Their square roots are the thresholds of the Huber cost.
struct ChiSquareLimits {
  double two = geometry::chi_square_two;
  double three = geometry::chi_square_three;

  double of(const BundleProblem::Observation& observation) const;
};

/// Squared residual of an observation over its variance, without its weight; infinite behind the camera, NaN for
/// numbers that are not finite.
double chi_square(const Camera& camera, const Eigen::Isometry3d& T_camera_world, const Eigen::Vector3d& point,
                  const BundleProblem::Observation& observation);

/// Whether the chi-square exceeds its limit, or the point lies behind the camera, or a number is not finite.
bool is_outlier(const Camera& camera, const Eigen::Isometry3d& T_camera_world, const Eigen::Vector3d& point,
                const BundleProblem::Observation& observation, const ChiSquareLimits& limits);

/// The selected part of a bundle problem. An observation counts if its numbers are finite, its weight is positive, its
/// point lies in front of the camera, and its point counts. A point counts if a free pose observes it, and if its
/// observations have at least three residuals.
struct BundleSelection {
  std::vector<std::uint8_t> observation_counts;
  std::vector<std::uint8_t> point_counts;
  std::vector<std::uint8_t> pose_moves;  ///< 1 for free poses with a selected observation or a factor

  /// Throws CheckError if the problem has no camera or an index out of range. Keeps its memory between calls.
  void select(const BundleProblem& problem);

 private:
  void select_by_factors(const BundleProblem& problem);

  std::vector<std::uint32_t> rows_;
};

}  // namespace holdfast
