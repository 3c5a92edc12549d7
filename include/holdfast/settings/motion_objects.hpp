// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `motion_objects`: what each value means, and its range, is in the reference (`holdfast modules
/// motion_objects`).
struct MotionObjectsSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "motion_objects";

  double suspicion = -1.0;
  double surface = 0.03;
  double interval = 0.2;
  double speed = 0.1;
  double moving_time = 0.2;
  double rest_time = 1.0;
  double memory = 1.0;
  double moving_log_odds = -4.0;
  double static_log_odds = 0.5;

  static void describe(ParameterTable<MotionObjectsSettings>& table);
};

}  // namespace holdfast
