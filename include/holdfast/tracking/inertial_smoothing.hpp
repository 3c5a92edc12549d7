// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/frame_history.hpp"

namespace holdfast {

/// Time stamps of frames that no view of the map placed [s], increasing.
struct UnplacedFrames {
  std::vector<double> frames;     ///< with a pose that drifts, no keyframes
  std::vector<double> keyframes;  ///< which no adjustment of the map has placed since
  std::vector<double> missing;    ///< without a pose
  double longest_gap = 0.0;       ///< time between tracked frames in which missing ones get a pose [s]; 0 = never
};

/// The frames of the main submap of a run, if inertial measurements link its keyframes.
struct RunPath {
  Trajectory trajectory;
  std::map<double, KeyFrameId> keyframes;  ///< of this run, by time stamp
  std::shared_ptr<const Camera> camera;    ///< none: empty
};
RunPath path_of(const FrameHistory& history, const Map& map, const InertialHistory& inertia);

/// What smoothing did.
struct InertialSmoothing {
  std::size_t smoothed = 0;  ///< frames whose pose is a new one
  std::size_t placed = 0;    ///< frames that had no pose
};

/// Estimates the poses of frames between keyframes again, at the end of a run: a fixed-interval smoother (Forster et
/// al. 2017, section VII; Campos et al. 2020), whose states are all frames that inertial measurements link. Tracked
/// frames have their poses as priors, with deviations estimated from a first solution; keyframes have priors of half
/// their median, and stay where they are. Frames that drift have none: what the map corrected behind a bridge is
/// thereby spread over it by the uncertainty of the measurements. These weigh a ninth of what their noise says, for
/// errors of the IMU's model. Drifting keyframes move with the points that no other keyframe observes. Where a link is
/// missing, the chain of frames ends; a bridge at the end of a chain stays as it is. Frames without a pose get one like
/// those that drift, between tracked frames that are at most `longest_gap` apart, and elsewhere within half a second of
/// those at the end of a chain that is as long. `stop`: from any thread; chains that were not solved yet stay.
InertialSmoothing smooth_by_inertia(FrameHistory& history, Map& map, const UnplacedFrames& unplaced,
                                    const InertialHistory& inertia, Optimizer& optimizer,
                                    const std::atomic<bool>& stop);

}  // namespace holdfast
