// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/keyframe_policy.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Keyframe decision for the current frame: collects the measurements and applies KeyframePolicy. Called by Tracker for
/// each frame, and by FlowTracker, because keyframes require extracted features. One thread, within the MapAccess of
/// Tracker::locate().
class KeyframeDecision {
 public:
  /// The context must outlive the object.
  explicit KeyframeDecision(TrackingContext& context) : context_(context), policy_(context.settings) {}

  /// Whether a frame with this result is due as a keyframe; always false in localisation mode.
  bool is_due(const FrameResult& result) const;
  /// Registers a keyframe created at this time [s].
  void keyframe_added(double timestamp) { last_time_ = timestamp; }
  /// Resets the state after the map was removed.
  void forget_map() { last_time_ = 0.0; }

 private:
  TrackingContext& context_;
  KeyframePolicy policy_;
  double last_time_ = 0.0;  // time of the last keyframe [s]
};

}  // namespace holdfast
