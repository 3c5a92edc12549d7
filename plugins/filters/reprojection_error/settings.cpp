// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/reprojection_error.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void ReprojectionErrorSettings::describe(ParameterTable<ReprojectionErrorSettings>& table) {
  using S = ReprojectionErrorSettings;
  table
      .add("threshold", &S::threshold,
           "a feature without depth fails when its squared error by the variance of its level is larger; 5.991 = "
           "95 % of what stands still passes")
      .range(0.1, 1000);
  table.add("threshold_depth", &S::threshold_depth, "the same for features with depth, which have a third residual")
      .range(0.1, 1000);
  table.add("frames", &S::frames, "a map point moves for certain after failing so often among its last eight sights")
      .range(1, 8)
      .unit("frame");
  table
      .add("support", &S::support,
           "share of the trusted matches that must pass; with fewer the pose itself may be wrong and nothing is said")
      .range(0, 1);
  table.add("least_matches", &S::least_matches, "with fewer trusted matches nothing is said").range(1, 100000);
  table
      .add("least_found_ratio", &S::least_found_ratio,
           "a map point that was found in a smaller share of the frames that should show it is unstable")
      .range(0, 1);
  table
      .add("agreement", &S::agreement,
           "a map point is displaced when its mean displacement is this share of the mean length of displacements; 1 "
           "= all in the same direction")
      .range(0, 1);
  table.add("moving_log_odds", &S::moving_log_odds, "said of what fails far and for long").range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "said of what passes").range(0, 20);
}

}  // namespace holdfast
