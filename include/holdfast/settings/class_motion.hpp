// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `class_motion`. Ranges and units: `holdfast modules class_motion`. Thread: any.
struct ClassMotionSettings {
  using Interface = Observer;
  static constexpr const char* module = "class_motion";

  double moving_log_odds = -1.0;  ///< measured log-odds of a feature from which on down it counts as moving

  static void describe(ParameterTable<ClassMotionSettings>& table);
};

}  // namespace holdfast
