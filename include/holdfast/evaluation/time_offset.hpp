// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// Time offset between an estimate and the ground truth.
struct TimeOffset {
  double offset = 0.0;         ///< to be added to the time stamps of the estimate [s]
  double error = 0.0;          ///< RMSE of the positions at this offset, after an alignment with scale [m]
  double error_without = 0.0;  ///< the same at the offset 0 [m]
  double spread = 0.0;         ///< RMS distance of the compared true positions from their mean [m]
  bool at_limit = false;       ///< the offset lies at the end of the range: the true one may be larger
};

/// Estimates the time offset that minimises the RMSE of the positions after an alignment with scale (Umeyama 1991), to
/// a tenth of a millisecond. The truth is interpolated linearly; if it has fewer than 9 poses per second and the
/// estimate more, the estimate. Offsets up to `range` [s] and up to a quarter of the common time span are compared, all
/// over the same poses. Both trajectories sorted, each stamp once. Empty if fewer than 20 poses can be compared, or if
/// the truth does not move.
std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth, const Trajectory& estimate, double range = 1.0);

}  // namespace holdfast
