// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/bridge_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace holdfast {

namespace {

constexpr double margin_seconds = 0.5;  // of tracked frames on both sides [s]
/// Standard deviations of tracked poses [m], [rad].
constexpr double position_deviation = 0.003, rotation_deviation = 0.002;

/// A bridge with its margins: frames `begin` to `end` - 1 of a trajectory.
struct Window {
  std::size_t begin = 0, end = 0;
  bool has_end = false;  ///< tracked frames follow the bridge
};

/// Bridges whose margins overlap share a window.
std::vector<Window> find_windows(const Trajectory& trajectory, const std::vector<std::uint8_t>& drifts) {
  std::vector<Window> windows;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (drifts[i] == 0) continue;
    std::size_t begin = i, end = i + 1;
    while (begin > 0 && trajectory[i].timestamp - trajectory[begin - 1].timestamp <= margin_seconds) --begin;
    while (end < trajectory.size() && trajectory[end].timestamp - trajectory[i].timestamp <= margin_seconds) ++end;
    if (windows.empty() || windows.back().end <= begin)
      windows.push_back({begin, end});
    else
      windows.back().end = end;
    windows.back().has_end = end > i + 1;  // by the last frame of the bridge
  }
  return windows;
}

BundleFactors::PosePrior prior_of(std::uint32_t pose, const Eigen::Isometry3d& T_camera_world) {
  geometry::Vector6d information;
  information.head<3>().setConstant(1.0 / (position_deviation * position_deviation));
  information.tail<3>().setConstant(1.0 / (rotation_deviation * rotation_deviation));
  return {pose, T_camera_world, information.asDiagonal()};
}

class BridgeSmoother {
 public:
  BridgeSmoother(FrameHistory& history, Map& map, const DriftingPoses& drifting, const InertialHistory& inertia)
      : history_(history), map_(map), inertia_(inertia), trajectory_(history.trajectory(map)) {
    const auto contains = [](const std::vector<double>& stamps, double stamp) {
      return std::binary_search(stamps.begin(), stamps.end(), stamp);
    };
    for (const TimedPose& pose : trajectory_)
      drifts_.push_back(contains(drifting.frames, pose.timestamp) || contains(drifting.keyframes, pose.timestamp) ? 1
                                                                                                                  : 0);
    const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
    const std::vector<double> stamps = linkable_stamps(map, keyframes, inertia);
    for (std::size_t i = 0; i < keyframes.size(); ++i)
      if (!std::isnan(stamps[i])) keyframes_[stamps[i]] = keyframes[i];
  }

  std::vector<Window> windows() const { return find_windows(trajectory_, drifts_); }

  BundleProblem problem_of(const Window& window) const {
    BundleProblem problem;
    problem.camera = map_.keyframe(map_.keyframes_by_age().front()).frame.camera.get();
    std::vector<double> timestamps;
    for (std::size_t i = window.begin; i < window.end; ++i) {
      const Eigen::Isometry3d T_camera_world = trajectory_[i].T_world_camera.inverse();
      if (drifts_[i] == 0)
        problem.factors.pose_priors.push_back(
            prior_of(static_cast<std::uint32_t>(problem.poses.size()), T_camera_world));
      problem.poses.push_back({T_camera_world, false});
      timestamps.push_back(trajectory_[i].timestamp);
    }
    add_inertial_factors(problem, inertia_.links(timestamps), inertia_);
    problem.robust_iterations = 0, problem.final_iterations = 50;  // no observation is an outlier
    problem.function_tolerance = 1e-6;
    return problem;
  }

  /// Writes the poses of a solution; returns their number.
  std::size_t write(const Window& window, const BundleProblem& solution) {
    move_keyframes(window, solution);
    std::size_t count = 0;
    for (std::size_t i = window.begin; i < window.end; ++i) {
      const double timestamp = trajectory_[i].timestamp;
      count += drifts_[i];
      if (keyframes_.contains(timestamp)) continue;
      if (drifts_[i] != 0) history_.replace(timestamp, solution.poses[i - window.begin].T_camera_world, map_);
    }
    return count;
  }

  /// Tracked frames stay, also where the keyframe has moved that they are relative to.
  void restore_tracked() {
    for (std::size_t i = 0; i < trajectory_.size(); ++i)
      if (drifts_[i] == 0 && !keyframes_.contains(trajectory_[i].timestamp))
        history_.replace(trajectory_[i].timestamp, trajectory_[i].T_world_camera.inverse(), map_);
  }

 private:
  /// Moves drifting keyframes, with the points that they alone observe.
  void move_keyframes(const Window& window, const BundleProblem& solution) {
    std::map<KeyFrameId, Eigen::Isometry3d> motions;  // T_world_world, from old to new
    for (std::size_t i = window.begin; i < window.end; ++i) {
      const auto found = keyframes_.find(trajectory_[i].timestamp);
      if (drifts_[i] == 0 || found == keyframes_.end()) continue;
      Eigen::Isometry3d& pose = map_.keyframe(found->second).frame.T_camera_world;
      const Eigen::Isometry3d& moved = solution.poses[i - window.begin].T_camera_world;
      motions[found->second] = moved.inverse() * pose;
      pose = moved;
    }
    if (motions.empty()) return;
    for (const MapPointId id : map_.points().ids()) {
      MapPoint& point = map_.point(id);
      const auto motion = motions.find(point.reference_keyframe);
      const auto moves = [&](const Observation& seen) { return motions.contains(seen.keyframe); };
      if (motion == motions.end() || !std::all_of(point.observations.begin(), point.observations.end(), moves))
        continue;
      point.position = motion->second * point.position;
      point.viewing_direction = motion->second.linear() * point.viewing_direction;
    }
    map_.invalidate_copies();
  }

  FrameHistory& history_;
  Map& map_;
  const InertialHistory& inertia_;
  const Trajectory trajectory_;             // before
  std::vector<std::uint8_t> drifts_;        // by frame of the trajectory
  std::map<double, KeyFrameId> keyframes_;  // by time stamp
};

}  // namespace

void follow_keyframes(FrameHistory& history, const Map& map, const Trajectory& before) {
  const Trajectory after = history.trajectory(map);
  if (after.size() != before.size()) return;
  const auto moved = [&](std::size_t keyframe, std::size_t i) {
    return after[keyframe].T_world_camera * before[keyframe].T_world_camera.inverse() * before[i].T_world_camera;
  };
  constexpr double longest = 2.0;  // s
  std::optional<std::size_t> first;
  for (std::size_t second = 0; second < after.size(); ++second) {
    const auto pose = history.past_pose(after[second].timestamp, map);
    if (!pose || !pose->is_keyframe) continue;
    if (first && after[second].timestamp - after[*first].timestamp > longest) first.reset();
    for (std::size_t i = first.value_or(second) + 1; i < second; ++i) {
      const double share =
          (after[i].timestamp - after[*first].timestamp) / (after[second].timestamp - after[*first].timestamp);
      const Eigen::Isometry3d a = moved(*first, i), b = moved(second, i);
      const Eigen::Quaterniond rotation = Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
      Eigen::Isometry3d T_world_camera(rotation);
      T_world_camera.translation() = (1.0 - share) * a.translation() + share * b.translation();
      history.replace(after[i].timestamp, T_world_camera.inverse(), map);
    }
    first = second;
  }
}

std::size_t smooth_bridges(FrameHistory& history, Map& map, const DriftingPoses& drifting,
                           const InertialHistory& inertia, Optimizer& optimizer, const std::atomic<bool>& stop) {
  if (map.keyframes().size() == 0 || history.main_submap(map) != inertia.submap()) return 0;
  BridgeSmoother smoother(history, map, drifting, inertia);
  std::size_t count = 0;
  for (const Window& window : smoother.windows()) {
    if (!window.has_end) continue;
    BundleProblem problem = smoother.problem_of(window);
    // A gap in the measurements would leave frames without a constraint.
    if (problem.factors.inertial.size() + 1 != problem.poses.size()) continue;
    const BundleSummary summary = optimizer.optimize_bundle(problem, stop);
    if (stop) break;
    if (summary.usable) count += smoother.write(window, problem);
  }
  if (count > 0) smoother.restore_tracked();
  return count;
}

}  // namespace holdfast
