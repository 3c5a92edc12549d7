// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Result of a full bundle adjustment.
struct FullAdjustmentSummary {
  BundleSummary bundle;
  bool applied = false;  ///< if false, the map is unchanged
  int keyframes = 0;
  int points = 0;
  int observations = 0;
  int keyframes_carried = 0;  ///< keyframes inserted meanwhile and moved with their parents
  int points_carried = 0;     ///< points inserted meanwhile and moved with their reference keyframes
  double seconds_per_iteration = 0.0;
  bool stop_requested = false;
  double stop_seconds = 0.0;  ///< from the request to the end of the solver; 0 without a request
};

}  // namespace holdfast
