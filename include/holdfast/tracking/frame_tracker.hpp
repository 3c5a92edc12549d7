// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/tracking/first_pose.hpp"
#include "holdfast/tracking/flow_tracker.hpp"
#include "holdfast/tracking/keyframe_decision.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Estimates the pose of one frame against the map. The methods of a list give first poses, LocalMapRefinement takes
/// them to the final one, MovingWorld decides what to trust in each step. A frame with followed features is tracked by
/// these first (FlowTracker). Knows nothing of how maps begin or of what follows a loss. Tracker calls begin() without
/// the lock of the map, and locate() with it. One thread.
class FrameTracker {
 public:
  /// The context and the decision must outlive the object.
  FrameTracker(TrackingContext& context, const KeyframeDecision& keyframes, FirstPoses first_poses);

  /// Builds context.current: propagates the mask and extracts or follows features. Does not read the map. More features
  /// than usual are extracted after a frame of whose features few were static.
  void begin(const SensorFrame& sensor_frame, TrackerState state, FrameResult& result);
  /// Finds the pose of context.current. False: it has none, and the result says why.
  bool locate(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  /// Whether the pose just found does not depend on the map, which ends here, and is certain enough for a keyframe.
  bool extends_map() const { return extends_map_; }
  /// Whether the current frame has features of its own, as a keyframe needs.
  bool has_own_features() const { return !flow_ || !flow_->is_following(); }
  /// The refinement, for poses that others propose.
  const LocalMapRefinement& local_map() const { return local_map_; }
  /// The map was removed.
  void forget_map();

 private:
  void find_features(const SensorFrame& sensor_frame, bool has_map, FrameResult& result);
  double feature_budget(bool has_map) const;
  bool find_pose(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  TrackingContext& context_;
  LocalMapRefinement local_map_;
  FirstPoses first_poses_;
  std::optional<FlowTracker> flow_;
  cv::Mat ignored_;  // pixels of the current frame in which no features should be extracted
  bool extends_map_ = false;
};

}  // namespace holdfast
