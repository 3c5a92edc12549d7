// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "frame_chains.hpp"

namespace holdfast {

namespace {

/// Deviations of the measurements by those of their noise: a mounting that is a degree wrong, scale factors or a time
/// offset are no white noise, and act for a second or more.
constexpr double model_factor = 3.0;

/// The poses of solved chains, and what they change.
class SmoothedFrames {
 public:
  SmoothedFrames(const FrameChains& frames, const std::map<double, KeyFrameId>& keyframes)
      : frames_(frames), keyframes_(keyframes), smoothed_(frames.trajectory().size()) {}

  /// Adopts the poses of a solution.
  void take(const FrameChain& chain, const BundleProblem& solution, Map& map) {
    move_keyframes(chain, solution, map);
    for (std::size_t i = chain.first; i < chain.last; ++i)
      if (frames_.role(i) != FrameChains::Role::keyframe) smoothed_[i] = solution.poses[i - chain.begin].T_camera_world;
  }

  /// Writes all frames, if any was smoothed: where a keyframe has moved, those that are relative to it and were not
  /// smoothed stay.
  InertialSmoothing write(FrameHistory& history, const Map& map) const {
    InertialSmoothing result;
    for (const std::optional<Eigen::Isometry3d>& pose : smoothed_) result.smoothed += pose ? 1 : 0;
    if (result.smoothed == 0) return result;
    for (std::size_t i = 0; i < frames_.trajectory().size(); ++i) {
      const auto& [timestamp, T_world_camera] = frames_.trajectory()[i];
      if (frames_.role(i) != FrameChains::Role::missing) {
        if (!keyframes_.contains(timestamp))
          history.replace(timestamp, smoothed_[i].value_or(T_world_camera.inverse()), map);
      } else if (smoothed_[i]) {
        Frame frame;
        frame.timestamp = timestamp;
        frame.T_camera_world = *smoothed_[i];
        history.add_past(frame, reference_near(i, history, map), map);
        ++result.placed;
      }
    }
    return result;
  }

 private:
  /// Reference keyframe of the nearest frame that had a pose.
  KeyFrameId reference_near(std::size_t frame, const FrameHistory& history, const Map& map) const {
    const Trajectory& trajectory = frames_.trajectory();
    const auto is_missing = [&](std::size_t i) { return frames_.role(i) == FrameChains::Role::missing; };
    std::size_t before = frame, after = frame;
    while (before > 0 && is_missing(before)) --before;
    while (after + 1 < trajectory.size() && is_missing(after)) ++after;
    const double time = trajectory[frame].timestamp;
    const bool is_after_nearer = trajectory[after].timestamp - time < time - trajectory[before].timestamp;
    const std::size_t nearest = is_missing(before) || (is_after_nearer && !is_missing(after)) ? after : before;
    return history.past_pose(trajectory[nearest].timestamp, map)->reference;
  }

  /// Moves drifting keyframes, with the points that they alone observe.
  void move_keyframes(const FrameChain& chain, const BundleProblem& solution, Map& map) {
    std::map<KeyFrameId, Eigen::Isometry3d> motions;  // T_world_world, from old to new
    for (std::size_t i = chain.first; i < chain.last; ++i) {
      const auto found = keyframes_.find(frames_.trajectory()[i].timestamp);
      if (!frames_.drifts(i) || found == keyframes_.end()) continue;
      Eigen::Isometry3d& pose = map.keyframe(found->second).frame.T_camera_world;
      const Eigen::Isometry3d& moved = solution.poses[i - chain.begin].T_camera_world;
      motions[found->second] = moved.inverse() * pose;
      pose = moved;
    }
    if (motions.empty()) return;
    for (const MapPointId id : map.points().ids()) {
      MapPoint& point = map.point(id);
      const auto motion = motions.find(point.reference_keyframe);
      const auto moves = [&](const Observation& seen) { return motions.contains(seen.keyframe); };
      if (motion == motions.end() || !std::all_of(point.observations.begin(), point.observations.end(), moves))
        continue;
      point.position = motion->second * point.position;
      point.viewing_direction = motion->second.linear() * point.viewing_direction;
    }
    map.invalidate_copies();
  }

  const FrameChains& frames_;
  const std::map<double, KeyFrameId>& keyframes_;           // by time stamp
  std::vector<std::optional<Eigen::Isometry3d>> smoothed_;  // T_camera_world, as far as chains were solved
};

}  // namespace

RunPath path_of(const FrameHistory& history, const Map& map, const InertialHistory& inertia) {
  RunPath path;
  if (map.keyframes().size() == 0 || history.main_submap(map) != inertia.submap()) return path;
  path.trajectory = history.trajectory(map);
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  const std::vector<double> stamps = linkable_stamps(map, keyframes, inertia);
  for (std::size_t i = 0; i < keyframes.size(); ++i)
    if (!std::isnan(stamps[i])) path.keyframes[stamps[i]] = keyframes[i];
  path.camera = map.keyframe(keyframes.front()).frame.camera;
  return path;
}

InertialSmoothing smooth_by_inertia(FrameHistory& history, Map& map, const UnplacedFrames& unplaced,
                                    const InertialHistory& inertia, Optimizer& optimizer,
                                    const std::atomic<bool>& stop) {
  const std::optional<MapInertia> estimates = inertia.estimates();
  if (!estimates) return {};
  const RunPath path = path_of(history, map, inertia);
  if (!path.camera) return {};
  const FrameChains frames(path, unplaced, inertia, *estimates, model_factor, false);
  SmoothedFrames smoothed(frames, path.keyframes);
  for (const FrameChain& chain : frames.find()) {
    const std::optional<BundleProblem> solution = frames.solve(chain, optimizer, stop);
    if (stop) break;
    if (solution) smoothed.take(chain, *solution, map);
  }
  return smoothed.write(history, map);
}

}  // namespace holdfast
