// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `motion_objects`. Ranges and units: `holdfast modules motion_objects`.
struct MotionObjectsSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "motion_objects";

  /// Log-odds of earlier filters at or below which a block is a motion hypothesis; a larger value finds more.
  double suspicion = -1.0;
  double surface = 0.03;  ///< minimum visible surface of an object [m^2]
  /// Maximum age of the frame with which an object is aligned [s]; a longer interval measures slow motion better.
  double interval = 0.2;
  double speed = 0.1;             ///< minimum speed of a moving object [m/s]
  double moving_time = 0.2;       ///< time that a candidate must have moved before it becomes an object [s]
  double rest_time = 1.0;         ///< time at rest after which an object counts as static again [s]
  double memory = 1.0;            ///< time that an occluded object is kept [s]
  double moving_log_odds = -4.0;  ///< evidence of the features on a moving object
  double static_log_odds = 0.5;   ///< evidence of the features on an object that came to rest

  static void describe(ParameterTable<MotionObjectsSettings>& table);
};

}  // namespace holdfast
