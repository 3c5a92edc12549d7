// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/tracking/feature_flow.hpp"
#include "holdfast/tracking/keyframe_decision.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Tracks frames between keyframes by optical flow of an earlier frame's features (BetweenKeyframes::flow).
/// FrameTracker calls follow() in the first half of a frame, without the lock of the map, and track() in the second,
/// with it. Without a pose from flow the frame is tracked by features of its own. One thread.
class FlowTracker {
 public:
  /// All must outlive the object.
  FlowTracker(TrackingContext& context, const LocalMapRefinement& local_map, const KeyframeDecision& keyframes)
      : context_(context), local_map_(local_map), keyframes_(keyframes) {}

  /// Gives the current frame the features of an earlier one that flow finds in its image. False if there are too few,
  /// or the camera was not tracked, and the frame needs features of its own.
  bool follow(const SensorFrame& sensor_frame, const cv::Mat& ignored, bool is_tracking, FrameResult& result);
  /// The final pose of a frame with followed features. False if they do not determine it, or if the frame is due as a
  /// keyframe, which needs features of its own.
  bool track(TrackedView& view, FrameResult& result);
  /// Whether the current frame has followed features.
  bool is_following() const { return frames_ > 0; }
  /// The current frame has features of its own.
  void stop() { frames_ = 0; }
  /// Gives up the features of earlier frames.
  void forget();

 private:
  TrackingContext& context_;
  const LocalMapRefinement& local_map_;
  const KeyframeDecision& keyframes_;
  FeatureFlow flow_;
  int frames_ = 0;  // in a row, up to the current one, that have features of an earlier frame
};

}  // namespace holdfast
