// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Measurements on which the decision about a keyframe depends.
struct KeyframeSituation {
  int inliers = 0;            ///< inlier matches of the frame
  int reference_points = 0;   ///< established points of the reference keyframe
  int close_tracked = 0;      ///< features with close depth that are matched with a map point
  int close_untracked = 0;    ///< features with close depth that could create map points
  std::size_t keyframes = 0;  ///< number of keyframes in the submap of the reference keyframe
  double since_last = 0.0;    ///< time since the last keyframe [s]
  double mask_age = 0.0;      ///< age of the propagated mask [s]; 0 without a mask
  bool on_hold = false;       ///< no further keyframes, because too many wait for their masks
};

/// Why a frame should become a keyframe.
enum class KeyframeReason {
  none,              ///< it should not become one
  nearly_lost,       ///< the number of inliers is critical; the only reason that applies while on_hold
  old_mask,          ///< the propagated mask is too old
  few_close_points,  ///< few close points are tracked, and many new ones could be created
  few_inliers,       ///< the view has changed: a small share of the reference keyframe's points is tracked
  interval,          ///< the maximum interval has passed, and the view has changed slightly
};

/// Decides which tracked frames become keyframes (after Mur-Artal and Tardos 2017, section III-E, with conditions for
/// masks and time). Stateless.
class KeyframePolicy {
 public:
  explicit KeyframePolicy(const TrackingSettings& settings) : settings_(settings) {}

  /// Counts the points of a frame that was tracked against a reference keyframe. The caller sets since_last, mask_age
  /// and on_hold. A removed reference keyframe has no points.
  KeyframeSituation measure(const Frame& frame, int inliers, KeyFrameId reference, const Map& map) const;
  /// The first reason that applies, in the order of KeyframeReason.
  KeyframeReason decide(const KeyframeSituation& situation) const;

 private:
  TrackingSettings settings_;
};

}  // namespace holdfast
