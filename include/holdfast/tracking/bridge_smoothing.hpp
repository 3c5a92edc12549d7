// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/frame_history.hpp"

namespace holdfast {

/// Estimates the poses of bridged frames (time stamps [s], increasing) again, from the frames on both sides of each
/// bridge as the map has them now: a fixed-interval smoother, whose problem has priors for the tracked frames within
/// half a second of the bridge and inertial factors between all successive frames. What the map corrected behind the
/// bridge is thereby spread over its frames by the uncertainty of the measurements. A bridge at the end of the history
/// stays as it is. Returns the number of frames with a new pose.
std::size_t smooth_bridges(FrameHistory& history, const Map& map, std::span<const double> bridged,
                           const InertialHistory& inertia, Optimizer& optimizer);

}  // namespace holdfast
