// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Inputs and state of the pose search of one frame, shared by its methods.
struct PoseSearch {
  TrackingContext& context;
  const LocalMapRefinement& local_map;
  const PoseSituation& situation;
  TrackedView& view;
  FrameResult& result;
  bool is_predicted = false;  ///< an earlier method has a prediction of the pose, so that relocalisation is not needed
  bool extends_map = false;   ///< the final pose is independent of the map and accurate enough for a keyframe
};

/// The result of a first-pose method.
enum class FirstPoseOutcome {
  none,        ///< no pose; the next method is tried
  first_pose,  ///< initial pose for the refinement against the local map; if that fails, the next method is tried
  final_pose,  ///< a pose that needs no further refinement
};

/// A method to estimate the initial pose of a frame, such as the motion model. FrameTracker tries a list of methods in
/// order until one leads to a final pose. A method sets pose and matches of context.current, and method, fallback or
/// failure of the result. One thread, within the MapAccess of Tracker::locate().
class FirstPose {
 public:
  virtual ~FirstPose() = default;
  /// Tries to estimate the pose of context.current. Methods that do not apply return `none` immediately.
  virtual FirstPoseOutcome find(PoseSearch& search) = 0;
};

/// Methods in the order in which they are tried.
using FirstPoses = std::vector<std::unique_ptr<FirstPose>>;

/// Aligns the depth image of a frame with something that is known of the room: T_camera_world from its predicted value.
/// Empty if the depth does not determine it. Adds its time to `times`.
using DepthAlignment = std::function<std::optional<Eigen::Isometry3d>(
    const Frame& frame, const Eigen::Isometry3d& predicted, StageTimes& times)>;

/// The methods of Holdfast: motion model, inertial search, reference keyframe, inertial return, odometry, masked
/// features, dense depth, inertial bridge, relocalisation. With `surface`, depth is aligned with that first, and then
/// with keyframes.
FirstPoses default_first_poses(const DepthAlignment& surface = {});

}  // namespace holdfast
