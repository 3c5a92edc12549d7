// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/schur.hpp"

#include "holdfast/interfaces/pose_adjustment_settings.hpp"

namespace holdfast {

void SchurSettings::describe(ParameterTable<SchurSettings>& table) {
  describe_pose_adjustment(table);
  table
      .add("function_tolerance", &SchurSettings::function_tolerance,
           "relative decrease of the cost at which a bundle adjustment has converged; full adjustment, and local "
           "adjustment of one camera, have their own")
      .range(0.0, 0.1);
  table
      .add("step_tolerance", &SchurSettings::step_tolerance,
           "largest step of a pose, in metres or radians, at which a bundle adjustment has converged; not used in full "
           "adjustment, and in local adjustment of one camera")
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
