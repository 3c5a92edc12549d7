// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/plugin/parameter_table.hpp"

/// Parameters of motion-only adjustment (geometry::adjust_pose) that are common to the settings of several optimizers,
/// as plain members of each: chi_square_two, chi_square_three, disparity_sigma, disparity_threshold, pose_rounds,
/// pose_iterations.
namespace holdfast {

/// Adds their rows to the table of `Settings`.
template <class Settings>
void describe_pose_adjustment(ParameterTable<Settings>& table) {
  static_assert(Settings{}.chi_square_two == geometry::chi_square_two &&
                Settings{}.chi_square_three == geometry::chi_square_three &&
                Settings{}.disparity_sigma == geometry::disparity_sigma &&
                Settings{}.disparity_threshold == geometry::disparity_threshold);
  table
      .add(
          "chi_square_two", &Settings::chi_square_two,
          "outlier threshold of the squared normalised residual without depth; 5.991 = chi-square 95 %, two degrees of "
          "freedom; its square root is the threshold of the Huber cost")
      .range(0.1, 1000.0);
  table
      .add("chi_square_three", &Settings::chi_square_three,
           "the same with depth; 7.815 = chi-square 95 %, three degrees of freedom")
      .range(0.1, 1000.0);
  table
      .add("disparity_sigma", &Settings::disparity_sigma,
           "standard deviation of the disparity that a measured depth stands for")
      .range(0.01, 100.0)
      .unit("px");
  table
      .add("disparity_threshold", &Settings::disparity_threshold,
           "threshold of the Huber cost of a disparity, in standard deviations")
      .range(0.1, 1000.0);
  table
      .add("pose_rounds", &Settings::pose_rounds,
           "rounds of motion-only adjustment with outlier re-classification, the first half with the Huber cost")
      .range(2, 10);
  table.add("pose_iterations", &Settings::pose_iterations, "maximum iterations of each round").range(1, 100);
}

/// Conversion to the options of the solver.
template <class Settings>
geometry::PoseAdjustmentOptions pose_adjustment_options(const Settings& settings) {
  geometry::PoseAdjustmentOptions options;
  options.robust_rounds = settings.pose_rounds / 2;
  options.final_rounds = settings.pose_rounds - options.robust_rounds;
  options.iterations = settings.pose_iterations;
  options.chi_square_2d = settings.chi_square_two;
  options.chi_square_3d = settings.chi_square_three;
  options.disparity_sigma = settings.disparity_sigma;
  options.disparity_threshold = settings.disparity_threshold;
  return options;
}

}  // namespace holdfast
