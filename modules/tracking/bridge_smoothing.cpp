// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/bridge_smoothing.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace holdfast {

namespace {

constexpr double margin_seconds = 0.5;  // of tracked frames on both sides [s]
/// Standard deviations of poses [m], [rad].
struct Deviations {
  double position = 0.0, rotation = 0.0;
};
constexpr Deviations of_tracked_frames{0.003, 0.002}, of_drifting_keyframes{0.3, 0.1};

/// A bridge with its margins: frames `begin` to `end` - 1 of a trajectory.
struct Window {
  std::size_t begin = 0, end = 0;
  bool has_end = false;  ///< tracked frames follow the bridge
};

/// Bridges whose margins overlap share a window.
std::vector<Window> find_windows(const Trajectory& trajectory, const std::vector<std::uint8_t>& is_bridged) {
  std::vector<Window> windows;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (is_bridged[i] == 0) continue;
    std::size_t begin = i, end = i + 1;
    while (begin > 0 && trajectory[i].timestamp - trajectory[begin - 1].timestamp <= margin_seconds) --begin;
    while (end < trajectory.size() && trajectory[end].timestamp - trajectory[i].timestamp <= margin_seconds) ++end;
    if (windows.empty() || windows.back().end <= begin)
      windows.push_back({begin, end});
    else
      windows.back().end = end;
    windows.back().has_end = end > i + 1 && is_bridged[end - 1] == 0;
  }
  return windows;
}

BundleFactors::PosePrior prior_of(std::uint32_t pose, const Eigen::Isometry3d& T_camera_world,
                                  const Deviations& deviations) {
  geometry::Vector6d information;
  information.head<3>().setConstant(1.0 / (deviations.position * deviations.position));
  information.tail<3>().setConstant(1.0 / (deviations.rotation * deviations.rotation));
  return {pose, T_camera_world, information.asDiagonal()};
}

}  // namespace

std::size_t smooth_bridges(FrameHistory& history, const Map& map, const DriftingPoses& drifting,
                           const InertialHistory& inertia, Optimizer& optimizer) {
  const Trajectory trajectory = history.trajectory(map);
  const auto contains = [](const std::vector<double>& stamps, double stamp) {
    return std::binary_search(stamps.begin(), stamps.end(), stamp);
  };
  std::vector<std::uint8_t> is_bridged;
  for (const TimedPose& pose : trajectory) is_bridged.push_back(contains(drifting.frames, pose.timestamp) ? 1 : 0);
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  if (keyframes.empty() || history.main_submap(map) != inertia.submap()) return 0;
  std::size_t count = 0;
  for (const Window& window : find_windows(trajectory, is_bridged)) {
    if (!window.has_end) continue;
    BundleProblem problem;
    problem.camera = map.keyframe(keyframes.front()).frame.camera.get();
    std::vector<double> timestamps;
    for (std::size_t i = window.begin; i < window.end; ++i) {
      const Eigen::Isometry3d T_camera_world = trajectory[i].T_world_camera.inverse();
      const auto pose = static_cast<std::uint32_t>(i - window.begin);
      const bool drifts = contains(drifting.keyframes, trajectory[i].timestamp);
      if (is_bridged[i] == 0)
        problem.factors.pose_priors.push_back(
            prior_of(pose, T_camera_world, drifts ? of_drifting_keyframes : of_tracked_frames));
      problem.poses.push_back({T_camera_world, false});
      timestamps.push_back(trajectory[i].timestamp);
    }
    add_inertial_factors(problem, inertia.links(timestamps), inertia);
    problem.robust_iterations = 0, problem.final_iterations = 50;  // no observation is an outlier
    problem.function_tolerance = 1e-6;
    // A gap in the measurements would leave frames without a constraint.
    if (problem.factors.inertial.size() + 1 != problem.poses.size()) continue;
    if (!optimizer.optimize_bundle(problem, std::atomic<bool>(false)).usable) continue;
    for (std::size_t i = window.begin; i < window.end; ++i) {
      if (is_bridged[i] == 0) continue;
      history.replace(trajectory[i].timestamp, problem.poses[i - window.begin].T_camera_world, map);
      ++count;
    }
  }
  return count;
}

}  // namespace holdfast
