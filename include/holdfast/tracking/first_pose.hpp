// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// The search for the pose of one frame, as its methods see it.
struct PoseSearch {
  TrackingContext& context;
  const LocalMapRefinement& local_map;
  const PoseSituation& situation;
  TrackedView& view;
  FrameResult& result;
  bool is_predicted = false;  ///< an earlier method predicted the pose; relocalisation would not find a better one
  bool extends_map = false;   ///< the final pose does not depend on the map and is certain enough for a keyframe
};

/// The result of a first-pose method.
enum class FirstPoseOutcome {
  none,        ///< no pose; the next method is tried
  first_pose,  ///< a pose to be refined against the local map; if that fails, the next method is tried
  final_pose,  ///< a pose that needs no further refinement
};

/// A method that gives a frame its first pose, such as the motion model. FrameTracker tries its methods in the order
/// of a list until one leads to a final pose. A method writes context.current (pose and matches), and the method,
/// fallback or failure of the result. One thread, within the MapAccess of Tracker::locate().
class FirstPose {
 public:
  virtual ~FirstPose() = default;
  /// Tries to find the pose of context.current. Methods that do not apply return `none` at once.
  virtual FirstPoseOutcome find(PoseSearch& search) = 0;
};

/// Methods in the order in which they are tried.
using FirstPoses = std::vector<std::unique_ptr<FirstPose>>;

/// The methods of Holdfast: motion model, inertial search, reference keyframe, odometry, masked features, dense depth,
/// inertial bridge, relocalisation.
FirstPoses default_first_poses();

}  // namespace holdfast
