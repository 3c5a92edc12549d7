// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"
#include "place_points.hpp"

namespace holdfast {

/// The way between two keyframes [m]: the shortest one through the graph of covisibility, spanning tree and loop edges,
/// each edge as long as its cameras are apart plus a metre for each radian between them (turning drifts, too). Shortest
/// and not as travelled: a camera that hovers does not drift, and who walks back along known places is held by them.
/// Infinite when nothing leads there.
double way_between(const Map& map, KeyFrameId from, KeyFrameId to);

/// How far a camera moves and turns from one pose to another.
PoseChange pose_change(const Eigen::Isometry3d& T_camera_world_before, const Eigen::Isometry3d& T_camera_world_after);

/// What odometry may have drifted on a way.
PoseChange believed_drift(const LoopClosingSettings& settings, double way, bool with_scale);

/// Points of the map that the keyframe should see from its present pose, and that neither it nor its neighbourhood nor
/// any keyframe younger than `minimum_gap` has seen.
PlacePoints old_points_in_view(const LoopClosingSettings& settings, const Map& map, KeyFrameId keyframe);

/// Whether such points are found where the present pose expects them, and say something else than the loop does.
/// Found: as many as make a place, after adjusting the pose to them.
bool present_pose_is_confirmed(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                               const Frame& frame, const PlacePoints& old_points,
                               const Eigen::Isometry3d& T_camera_world_loop);

}  // namespace holdfast
