// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/ceres.hpp"

#include "holdfast/interfaces/pose_adjustment_settings.hpp"

namespace holdfast {

void CeresSettings::describe(ParameterTable<CeresSettings>& table) {
  describe_pose_adjustment(table);
  table
      .add("function_tolerance", &CeresSettings::function_tolerance,
           "relative decrease of the cost at which bundle adjustment and pose graph have converged")
      .range(0.0, 0.1);
  table
      .add("dense_poses", &CeresSettings::dense_poses,
           "maximum number of free poses for which the reduced camera system is factorised as a dense matrix")
      .range(0, 1000);
}

}  // namespace holdfast
