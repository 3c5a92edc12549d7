// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"
#include "place_points.hpp"

namespace holdfast {

/// Length of the shortest path between two keyframes [m] in the graph of covisibility, spanning tree and loop edges.
/// The length of an edge is the distance of its cameras plus one metre per radian between them, because rotation
/// drifts, too. The shortest path and not the travelled one bounds the drift, because revisited places constrain the
/// pose. Infinite without a path. An edge of fewer shared points than twice the minimum holds the camera by hardly a
/// view, and is longer by `metres_per_second` for each second between its keyframes, up to 5 s.
double path_length(const Map& map, KeyFrameId from, KeyFrameId to, double metres_per_second = 0.0);

/// Translation and rotation between two poses of a camera.
PoseChange pose_change(const Eigen::Isometry3d& T_camera_world_before, const Eigen::Isometry3d& T_camera_world_after);

/// Upper bound of the drift accumulated over a path of this length.
PoseChange drift_bound(const LoopClosingSettings& settings, double path_length, bool scale_is_free);

/// Map points predicted to be visible from the current pose of the keyframe that are observed neither by it nor by its
/// neighbourhood nor by any keyframe younger than `minimum_gap`.
PlacePoints old_points_in_view(const LoopClosingSettings& settings, const Map& map, KeyFrameId keyframe);

/// Tests the current pose as the competing hypothesis: whether enough of these points are matched at their predictions
/// to verify a place, after motion-only adjustment, and disagree with the loop.
bool present_pose_is_confirmed(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                               const Frame& frame, const PlacePoints& old_points,
                               const Eigen::Isometry3d& T_camera_world_loop);

}  // namespace holdfast
