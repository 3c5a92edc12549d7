// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// See RelativeError. Both trajectories sorted, each stamp once, at least 2 poses each; `scale` multiplies the
/// translations of the estimate.
RelativeError relative_error_per_time(const Trajectory& truth, const Trajectory& estimate, double time_step,
                                      double scale);
RelativeError relative_error_per_way(const Trajectory& truth, const Trajectory& estimate, double path_step,
                                     double scale);

/// See SegmentError; the same requirements.
SegmentError segment_error(const Trajectory& truth, const Trajectory& estimate, double scale);

/// The stamps of a trajectory.
std::vector<double> stamps_of(const Trajectory& trajectory);

}  // namespace holdfast
