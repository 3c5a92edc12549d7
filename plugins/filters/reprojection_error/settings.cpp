// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/reprojection_error.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void ReprojectionErrorSettings::describe(ParameterTable<ReprojectionErrorSettings>& table) {
  using S = ReprojectionErrorSettings;
  table
      .add("threshold", &S::threshold,
           "maximum squared normalised reprojection error of a match without depth; 5.991 = chi-square 95 %, two "
           "degrees of freedom")
      .range(0.1, 1000);
  table
      .add("threshold_depth", &S::threshold_depth,
           "the same for a match with depth; 7.815 = chi-square 95 %, three degrees of freedom")
      .range(0.1, 1000);
  table
      .add("frames", &S::frames,
           "number of failures among the last eight observations of a map point that give full evidence")
      .range(1, 8)
      .unit("frame");
  table
      .add(
          "support", &S::support,
          "minimum fraction of the trusted matches that must pass; below it the pose may be wrong, and the filter adds "
          "no evidence")
      .range(0, 1);
  table
      .add("minimum_matches", &S::minimum_matches,
           "minimum number of trusted matches; below it the filter adds no evidence")
      .range(1, 100000);
  table.add("minimum_found_ratio", &S::minimum_found_ratio, "found ratio below which a map point is unstable")
      .range(0, 1);
  table
      .add("agreement", &S::agreement,
           "ratio of the length of the mean displacement to the mean length from which on displacements agree; 1 = all "
           "parallel")
      .range(0, 1);
  table.add("soften", &S::soften,
            "whether evidence grows with the number of failures and the size of the error, and is halved where "
            "displacements do not agree; false = all of it after the given number of failures or on an unstable point, "
            "none before, as in Zeng et al. 2023");
  table.add("moving_log_odds", &S::moving_log_odds, "evidence of a match with a large and persistent error")
      .range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "evidence of a match that passes").range(0, 20);
}

}  // namespace holdfast
