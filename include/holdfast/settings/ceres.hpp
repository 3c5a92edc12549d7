// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Optimizer;
template <class Settings>
class ParameterTable;

/// Settings of the optimizer `ceres`. Ranges and units: `holdfast modules ceres`.
struct CeresSettings {
  using Interface = Optimizer;
  static constexpr const char* module = "ceres";

  /// Outlier threshold of the squared normalised residual without depth: chi-square 95 %, two degrees of freedom.
  double chi_square_two = 5.991;
  double chi_square_three = 7.815;   ///< the same with depth: chi-square 95 %, three degrees of freedom
  double disparity_sigma = 0.7;      ///< standard deviation of the disparity equivalent to a depth [px]
  double disparity_threshold = 1.5;  ///< of the Huber cost of the disparity [standard deviations]
  /// Rounds of motion-only adjustment with outlier re-classification, as in ORB-SLAM2; the first half robust.
  int pose_rounds = 4;
  int pose_iterations = 10;  ///< maximum iterations of each round, as in ORB-SLAM2
  /// Relative decrease of the cost at which bundle adjustment and pose graph have converged.
  double function_tolerance = 1e-5;
  /// Maximum number of free poses for which the reduced camera system is factorised as a dense matrix.
  int dense_poses = 30;

  static void describe(ParameterTable<CeresSettings>& table);
};

}  // namespace holdfast
