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

/// Tracks frames between keyframes by optical flow of the features of an earlier frame (BetweenKeyframes::flow). For
/// each frame FrameTracker calls follow() without the lock of the map, then track() with it. If optical flow gives no
/// pose, features are extracted and the frame is tracked by these. One thread.
class FlowTracker {
 public:
  /// All must outlive the object.
  FlowTracker(TrackingContext& context, const LocalMapRefinement& local_map, const KeyframeDecision& keyframes)
      : context_(context), local_map_(local_map), keyframes_(keyframes) {}

  /// Sets the features of the current frame by optical flow of those of an earlier frame. False if features must be
  /// extracted instead, because too few were found or the last frame has no pose.
  bool follow(const SensorFrame& sensor_frame, const cv::Mat& ignored, bool is_tracking, FrameResult& result);
  /// Estimates the final pose by the features of follow(). False if features must be extracted instead, because the
  /// pose is not determined or the frame is due as a keyframe.
  bool track(TrackedView& view, FrameResult& result);
  /// True if the features of the current frame come from optical flow.
  bool is_following() const { return frames_ > 0; }
  /// Registers that features were extracted from the current frame.
  void stop() { frames_ = 0; }
  /// Removes the template.
  void forget();

 private:
  TrackingContext& context_;
  const LocalMapRefinement& local_map_;
  const KeyframeDecision& keyframes_;
  FeatureFlow flow_;
  int frames_ = 0;  // number of consecutive frames tracked by flow, including the current one
};

}  // namespace holdfast
