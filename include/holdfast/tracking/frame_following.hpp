// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/tracking/frame_history.hpp"

namespace holdfast {

/// The frames of the main submap with the unit of their surroundings, at one state of the map.
struct PlacedFrames {
  Trajectory trajectory;
  std::vector<double> scales;  ///< KeyFrame::scale of the reference keyframe of each frame
};
PlacedFrames placed_frames(const FrameHistory& history, const Map& map);

/// Moves the frames between keyframes as an adjustment of the map has moved the keyframes before and after them:
/// between both corrections (similarities with one camera), by time. Relative to their reference keyframe alone, frames
/// keep its old surroundings, of another scale where the adjustment has corrected that. Frames between keyframes more
/// than two seconds apart stay as they are: they were tracked in a part of the map that is older. `before`: the frames
/// of this history before the adjustment.
void follow_keyframes(FrameHistory& history, const Map& map, const PlacedFrames& before);

}  // namespace holdfast
