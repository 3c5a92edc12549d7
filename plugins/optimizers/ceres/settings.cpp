// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/ceres.hpp"

#include "holdfast/geometry/pose_adjustment.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

static_assert(CeresSettings{}.chi_square_two == geometry::chi_square_two &&
              CeresSettings{}.chi_square_three == geometry::chi_square_three);

void CeresSettings::describe(ParameterTable<CeresSettings>& table) {
  table
      .add("chi_square_two", &CeresSettings::chi_square_two,
           "outlier limit of the squared residual over its variance, observations with x and y; its square root is "
           "Huber's threshold")
      .range(0.1, 1000.0);
  table.add("chi_square_three", &CeresSettings::chi_square_three, "the same for observations with x, y and depth")
      .range(0.1, 1000.0);
  table
      .add("pose_rounds", &CeresSettings::pose_rounds,
           "outlier rounds of motion-only adjustment, the first half of them with Huber's cost")
      .range(2, 10);
  table.add("pose_iterations", &CeresSettings::pose_iterations, "iterations at most in each of these rounds")
      .range(1, 100);
  table
      .add("function_tolerance", &CeresSettings::function_tolerance,
           "bundle adjustment and pose graph stop when an iteration lowers the cost by less than this part of it")
      .range(0.0, 0.1);
  table
      .add("dense_poses", &CeresSettings::dense_poses,
           "the reduced camera system of bundle adjustment is dense up to this number of free poses, sparse beyond")
      .range(0, 1000);
}

}  // namespace holdfast
