// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/inertial_consistency.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void InertialConsistencySettings::describe(ParameterTable<InertialConsistencySettings>& table) {
  using S = InertialConsistencySettings;
  table
      .add("threshold", &S::threshold,
           "maximum squared normalised innovation of a match without depth; 9.21 = chi-square 99 %, two degrees of "
           "freedom")
      .range(0.1, 1000);
  table
      .add("threshold_depth", &S::threshold_depth,
           "the same for a match with depth; 11.34 = chi-square 99 %, three degrees of freedom")
      .range(0.1, 1000);
  table
      .add("pixel_deviation", &S::pixel_deviation,
           "standard deviation of the pixel of a static match at the finest pyramid level, for the true pose")
      .range(0.1, 100)
      .unit("px");
  table
      .add(
          "largest_deviation", &S::largest_deviation,
          "standard deviation of the predicted pixel, by the uncertainty of the predicted pose, above which a match is "
          "not judged")
      .range(0.1, 1000)
      .unit("px");
  table.add("inflation", &S::inflation, "factor on the standard deviations of the predicted pose").range(1, 100);
  table
      .add("minimum_consistent", &S::minimum_consistent,
           "number of matches that must agree with the prediction; below it the filter adds no evidence, because the "
           "prediction may be wrong")
      .range(1, 100000);
  table
      .add("moving_log_odds", &S::moving_log_odds,
           "evidence of a match whose squared innovation is at least four times the threshold; a quarter of it at the "
           "threshold")
      .range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "evidence of a match that agrees with the prediction").range(0, 20);
}

}  // namespace holdfast
