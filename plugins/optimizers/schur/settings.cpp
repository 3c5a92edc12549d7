// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/schur.hpp"

#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

static_assert(SchurSettings{}.chi_square_two == geometry::chi_square_two &&
              SchurSettings{}.chi_square_three == geometry::chi_square_three &&
              SchurSettings{}.disparity_sigma == geometry::disparity_sigma &&
              SchurSettings{}.disparity_threshold == geometry::disparity_threshold);

void SchurSettings::describe(ParameterTable<SchurSettings>& table) {
  table
      .add(
          "chi_square_two", &SchurSettings::chi_square_two,
          "outlier threshold of the squared normalised residual without depth; 5.991 = chi-square 95 %, two degrees of "
          "freedom; its square root is the threshold of the Huber cost")
      .range(0.1, 1000.0);
  table
      .add("chi_square_three", &SchurSettings::chi_square_three,
           "the same with depth; 7.815 = chi-square 95 %, three degrees of freedom")
      .range(0.1, 1000.0);
  table
      .add("disparity_sigma", &SchurSettings::disparity_sigma,
           "standard deviation of the disparity that a measured depth stands for")
      .range(0.01, 100.0)
      .unit("px");
  table
      .add("disparity_threshold", &SchurSettings::disparity_threshold,
           "threshold of the Huber cost of a disparity, in standard deviations")
      .range(0.1, 1000.0);
  table
      .add("pose_rounds", &SchurSettings::pose_rounds,
           "rounds of motion-only adjustment with outlier re-classification, the first half with the Huber cost")
      .range(2, 10);
  table.add("pose_iterations", &SchurSettings::pose_iterations, "maximum iterations of each round").range(1, 100);
  table
      .add("function_tolerance", &SchurSettings::function_tolerance,
           "relative decrease of the cost at which a bundle adjustment has converged; full adjustment has its own")
      .range(0.0, 0.1);
  table
      .add("step_tolerance", &SchurSettings::step_tolerance,
           "largest step of a pose, in metres or radians, at which a bundle adjustment has converged; not used in full "
           "adjustment")
      .range(0.0, 0.01);
  table
      .add("graph_tolerance", &SchurSettings::graph_tolerance,
           "relative decrease of the cost at which a pose graph has converged")
      .range(0.0, 0.1);
  table
      .add("dense_poses", &SchurSettings::dense_poses,
           "maximum number of free poses for which the reduced camera system is factorised as a dense matrix")
      .range(0, 1000);
}

}  // namespace holdfast
