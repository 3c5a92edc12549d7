// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `reprojection_error`: what each value means, and its range, is in the reference (`holdfast modules
/// reprojection_error`).
struct ReprojectionErrorSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "reprojection_error";

  double threshold = 5.991;
  double threshold_depth = 7.815;
  int frames = 3;
  double support = 0.85;
  int least_matches = 30;
  double least_found_ratio = 0.35;
  double agreement = 0.7;
  double moving_log_odds = -1.0;
  double static_log_odds = 0.0;

  static void describe(ParameterTable<ReprojectionErrorSettings>& table);
};

}  // namespace holdfast
