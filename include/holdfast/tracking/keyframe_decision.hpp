// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/keyframe_policy.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Measures whether the frame being tracked should become a keyframe and asks KeyframePolicy. Tracker asks once a
/// frame; FlowTracker asks as well, because a keyframe needs features of its own. One thread, within
/// the MapAccess of Tracker::locate().
class KeyframeDecision {
 public:
  /// The context must outlive the object.
  explicit KeyframeDecision(TrackingContext& context) : context_(context), policy_(context.settings) {}

  /// Whether a frame with this result is due as a keyframe; never when only localising.
  bool is_due(const FrameResult& result) const;
  /// A keyframe was made at this time [s].
  void keyframe_added(double timestamp) { last_time_ = timestamp; }
  /// The map was removed.
  void forget_map() { last_time_ = 0.0; }

 private:
  TrackingContext& context_;
  KeyframePolicy policy_;
  double last_time_ = 0.0;  // of the last keyframe [s]
};

}  // namespace holdfast
