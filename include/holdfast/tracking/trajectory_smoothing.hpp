// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/tracking/frame_history.hpp"

namespace holdfast {

/// The trajectory with errors that change from frame to frame removed, as far as the accelerations of the camera allow
/// (geometry/path_smoothing.hpp): its positions in the world frame, and the path of its rotation, to which each frame
/// adds the rotation vector of its step. Time stamps increase.
Trajectory smooth_trajectory(const Trajectory& trajectory);

/// Replaces the poses of the history by those of its smoothed trajectory, at the end of a run. The map stays as it is,
/// and so do the poses of its keyframes there.
void smooth_trajectory(FrameHistory& history, const Map& map);

}  // namespace holdfast
