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

/// Estimates the pose of one frame against the map: initial poses by a list of methods (FirstPose), refinement against
/// the local map (LocalMapRefinement), weights of features by MovingWorld in each step. With features from optical
/// flow, FlowTracker is tried first. Initialisation and losses are handled by MapStart and LossRecovery. Tracker calls
/// begin() without the lock of the map and locate() with it. One thread.
class FrameTracker {
 public:
  /// The context and the decision must outlive the object.
  FrameTracker(TrackingContext& context, const KeyframeDecision& keyframes, FirstPoses first_poses);

  /// Builds context.current: propagates the mask, and extracts features or tracks them by optical flow. Does not read
  /// the map. The number of features is increased if few features of the last frame were static.
  void begin(const SensorFrame& sensor_frame, TrackerState state, FrameResult& result);
  /// Estimates the pose of context.current. False without a pose; the result then has the failure.
  bool locate(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  /// True if the last pose was estimated by odometry beyond the mapped area and is accurate enough for a keyframe.
  bool extends_map() const { return extends_map_; }
  /// True if features were extracted from the current frame, as keyframes require.
  bool has_own_features() const { return !flow_ || !flow_->is_following(); }
  /// The refinement against the local map, for poses of other components.
  const LocalMapRefinement& local_map() const { return local_map_; }
  /// Resets the state after the map was removed.
  void forget_map();

 private:
  void find_features(const SensorFrame& sensor_frame, bool has_map, FrameResult& result);
  double feature_budget(bool has_map) const;
  bool find_pose(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  TrackingContext& context_;
  LocalMapRefinement local_map_;
  FirstPoses first_poses_;
  std::optional<FlowTracker> flow_;
  cv::Mat ignored_;  // pixels of the current frame that are excluded from feature extraction
  bool extends_map_ = false;
};

}  // namespace holdfast
