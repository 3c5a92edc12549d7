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

/// Moves the frames between keyframes as an adjustment of the map has moved the keyframes before and after them:
/// between both corrections, by time. Relative to their reference keyframe alone, frames keep its old surroundings, of
/// another scale where the adjustment has corrected that. Frames between keyframes more than two seconds apart stay as
/// they are: they were tracked in a part of the map that is older. `before`: the trajectory of this history before the
/// adjustment.
void follow_keyframes(FrameHistory& history, const Map& map, const Trajectory& before);

/// Scale of one camera's map by all inertial measurements of a run.
struct ScaleEstimate {
  double scale = 1.0;      ///< metres in a unit of the map
  double deviation = 0.0;  ///< relative standard deviation of the scale
  /// In the world frame [m/s^2], of the chain of frames that determines the scale best.
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
};

/// Estimates the scale of the trajectory as a further unknown of the problem of smooth_by_inertia(), with measurements
/// weighted by their noise; the map and the poses stay. All frames count, because much of the acceleration of a hand is
/// too fast for keyframes. The poses must not be smoothed: a smoothed path has smaller accelerations, and too large a
/// scale. The standard deviation is that of the profile of the cost; it grows with the root of the mean squared
/// residual if that is larger than 1. Several chains of frames are weighted by their information; errors of the IMU's
/// model are common to them, and one camera's scale may drift, so that the result is at most twice as certain as the
/// best one, and less certain where they disagree. `estimates`: initial values. Empty if there is no chain.
std::optional<ScaleEstimate> estimate_scale(const RunPath& path, const UnplacedFrames& unplaced,
                                            const InertialHistory& inertia, const MapInertia& estimates,
                                            Optimizer& optimizer, const std::atomic<bool>& stop);

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
