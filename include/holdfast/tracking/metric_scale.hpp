// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <optional>

#include "holdfast/tracking/inertial_smoothing.hpp"

namespace holdfast {

/// Gravity, biases, calibration and scale of one camera's map by the measurements of the whole run, at its end: first
/// estimates are those of tracking (`tracked`), or else an inertial start (geometry::start_inertially) on up to 20 s of
/// the trajectory; then estimate_scale() gives the scale and gravity. The trajectory must not be smoothed. Empty if it
/// has no 5 s that measurements link, or if the scale has a standard deviation of more than 1 %.
std::optional<MapInertia> estimate_metres(const RunPath& path, const UnplacedFrames& unplaced,
                                          const InertialHistory& inertia, const std::optional<MapInertia>& tracked,
                                          Optimizer& optimizer, const std::atomic<bool>& stop);

}  // namespace holdfast
