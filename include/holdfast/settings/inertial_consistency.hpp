// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `inertial_consistency`. Ranges and units: `holdfast modules inertial_consistency`.
struct InertialConsistencySettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "inertial_consistency";

  double threshold = 9.21;         ///< chi-square 99 %, two degrees of freedom
  double threshold_depth = 11.34;  ///< chi-square 99 %, three degrees of freedom
  double pixel_deviation = 1.5;    ///< of a static match without an error of the pose, at the finest level [px]
  /// Standard deviation of the predicted pixel above which a match is not judged [px].
  double largest_deviation = 6.0;
  double inflation = 2.0;       ///< factor on the standard deviations of the prediction
  int minimum_consistent = 20;  ///< matches that must agree with the prediction; below it no match is judged
  double moving_log_odds = -1.5;
  double static_log_odds = 0.0;

  static void describe(ParameterTable<InertialConsistencySettings>& table);
};

}  // namespace holdfast
