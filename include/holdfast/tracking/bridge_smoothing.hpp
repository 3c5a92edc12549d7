// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/frame_history.hpp"

namespace holdfast {

/// Time stamps of frames that no view of the map placed [s], increasing.
struct DriftingPoses {
  std::vector<double> frames;     ///< no keyframes
  std::vector<double> keyframes;  ///< which no adjustment of the map has placed since
};

/// Moves the frames between keyframes as an adjustment of the map has moved the keyframes before and after them:
/// between both corrections, by time. Relative to their reference keyframe alone, frames keep its old surroundings, of
/// another scale where the adjustment has corrected that. Frames between keyframes more than two seconds apart stay as
/// they are: they were tracked in a part of the map that is older. `before`: the trajectory of this history before the
/// adjustment.
void follow_keyframes(FrameHistory& history, const Map& map, const Trajectory& before);

/// Estimates the poses of bridges again, from the frames on both sides of each as the map has them now: a
/// fixed-interval smoother, whose problem has priors for the tracked frames within half a second of the bridge and
/// inertial factors between all successive frames. What the map corrected behind the bridge is thereby spread over it
/// by the uncertainty of the measurements. Drifting keyframes move with the points that no other keyframe observes. A
/// bridge at the end of the history stays as it is. Returns the number of frames with a new pose. `stop`: from any
/// thread; bridges that were not written yet stay.
std::size_t smooth_bridges(FrameHistory& history, Map& map, const DriftingPoses& drifting,
                           const InertialHistory& inertia, Optimizer& optimizer, const std::atomic<bool>& stop);

}  // namespace holdfast
