// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map_snapshot.hpp"

namespace holdfast::test {

inline KeyFrameId keyframe_id(std::uint32_t slot) { return {slot, 0}; }
inline MapPointId point_id(std::uint32_t slot, std::uint32_t generation = 0) { return {slot, generation}; }

inline Eigen::Isometry3d pose_at(double x, double y = 0.0, double z = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

/// Keyframes a metre apart, a second apart, with a point each.
inline MapSnapshot row_map(std::uint32_t keyframes) {
  MapSnapshot map;
  for (std::uint32_t i = 0; i < keyframes; ++i) {
    map.keyframes.push_back({keyframe_id(i), i, static_cast<double>(i), pose_at(i)});
    map.points.push_back({point_id(i), Eigen::Vector3d(i, 0, 2), 3, 1.0F});
    if (i > 0) map.covisibility.push_back({keyframe_id(i - 1), keyframe_id(i)});
  }
  return map;
}

/// A frame at a keyframe of row_map(), tracked.
inline FrameResult row_frame(std::uint32_t keyframe, double seconds_after = 0.0) {
  FrameResult result;
  result.index = keyframe;
  result.timestamp = keyframe + seconds_after;
  result.status = TrackingStatus::tracked;
  result.method = TrackingMethod::motion_model;
  result.keyframe = keyframe_id(keyframe);
  result.T_world_camera = pose_at(keyframe + seconds_after);
  result.tracking_seconds = 0.005;
  result.times.add("features", 0.004);
  return result;
}

}  // namespace holdfast::test
