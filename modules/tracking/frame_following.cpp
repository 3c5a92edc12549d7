// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_following.hpp"

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

namespace holdfast {

PlacedFrames placed_frames(const FrameHistory& history, const Map& map) {
  PlacedFrames frames;
  frames.trajectory = history.trajectory(map);
  frames.scales.reserve(frames.trajectory.size());
  for (const TimedPose& pose : frames.trajectory) {
    const auto past = history.past_pose(pose.timestamp, map);
    frames.scales.push_back(past ? map.scale_of(past->reference) : 1.0);
  }
  return frames;
}

void follow_keyframes(FrameHistory& history, const Map& map, const PlacedFrames& before) {
  const PlacedFrames after = placed_frames(history, map);
  const Trajectory &path = after.trajectory, &old_path = before.trajectory;
  if (path.size() != old_path.size()) return;
  const auto moved = [&](std::size_t keyframe, std::size_t i) {
    Eigen::Isometry3d T_keyframe_camera = old_path[keyframe].T_world_camera.inverse() * old_path[i].T_world_camera;
    T_keyframe_camera.translation() *= after.scales[keyframe] / before.scales[keyframe];
    return path[keyframe].T_world_camera * T_keyframe_camera;
  };
  constexpr double longest = 2.0;  // s
  std::optional<std::size_t> first;
  for (std::size_t second = 0; second < path.size(); ++second) {
    const auto pose = history.past_pose(path[second].timestamp, map);
    if (!pose || !pose->is_keyframe) continue;
    if (first && path[second].timestamp - path[*first].timestamp > longest) first.reset();
    for (std::size_t i = first.value_or(second) + 1; i < second; ++i) {
      const double share =
          (path[i].timestamp - path[*first].timestamp) / (path[second].timestamp - path[*first].timestamp);
      const Eigen::Isometry3d a = moved(*first, i), b = moved(second, i);
      const Eigen::Quaterniond rotation = Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
      Eigen::Isometry3d T_world_camera(rotation);
      T_world_camera.translation() = (1.0 - share) * a.translation() + share * b.translation();
      history.replace(path[i].timestamp, T_world_camera.inverse(), map);
    }
    first = second;
  }
}

}  // namespace holdfast
