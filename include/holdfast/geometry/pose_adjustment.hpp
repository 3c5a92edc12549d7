// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

/// Chi-square limits at 95 % for observations with two (x, y) and three (x, y, right_x) residuals.
inline constexpr double chi_square_two = 5.991;
inline constexpr double chi_square_three = 7.815;

/// Points nearer to the image plane than this, or behind it, are outliers [m].
inline constexpr double minimum_depth = 1e-3;

/// Rounds and limits of adjust_pose().
struct PoseAdjustmentOptions {
  int robust_rounds = 2;              ///< with Huber's cost
  int final_rounds = 2;               ///< without it
  bool trust_guess = false;           ///< the first guess already decides which observations count in the first round
  int iterations = 10;                ///< at most, per round
  double limit_two = chi_square_two;  ///< an observation with two residuals beyond this is an outlier
  double limit_three = chi_square_three;  ///< an observation with three residuals beyond this is an outlier
};

/// Motion-only bundle adjustment (Mur-Artal and Tardos 2017, equation 3): the pose of one camera against fixed points
/// by Levenberg-Marquardt on a left perturbation of T_camera_world.
///
/// Rounds: after each one every observation is decided anew, an outlier being one whose squared residual times
/// inverse_sigma2 exceeds the chi-square limit, or whose point lies behind the camera; outliers have no say in the
/// next round. Huber's threshold is the square root of the limit. `weight` scales an observation's cost and not its
/// chi-square test; weight 0 leaves it out of the pose and of the count of inliers, while its `inlier` entry still says
/// whether it fits. An observation with a number that is not finite is never an inlier.
///
/// Not usable (pose unchanged, every inlier entry 0): fewer than three observations that count, a point set that does
/// not determine the pose, or fewer than three inliers at the end. Arrays shorter than `points` throw CheckError.
///
/// Same bits on every processor. Thread-safe; keeps scratch memory per thread, so it allocates only when a problem is
/// larger than all before it.
PoseSummary adjust_pose(PoseProblem& problem, const PoseAdjustmentOptions& options = {});

}  // namespace holdfast::geometry
