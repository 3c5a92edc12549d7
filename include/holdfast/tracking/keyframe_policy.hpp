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
  int inliers = 0;            ///< map points that agree with the frame's pose
  int reference_points = 0;   ///< established points of the reference keyframe
  int close_tracked = 0;      ///< features with trusted depth that show a map point
  int close_untracked = 0;    ///< features with trusted depth that could become new map points
  std::size_t keyframes = 0;  ///< in the reference's submap
  double since_last = 0.0;    ///< time since the last keyframe [s]
  double mask_age = 0.0;      ///< of the propagated mask [s]; 0 without a mask
  bool on_hold = false;       ///< so many keyframes wait for their masks that no more should be made
};

/// Why a frame should become a keyframe.
enum class KeyframeReason {
  none,              ///< it should not
  nearly_lost,       ///< too few inliers for the next frame to be safe; the only reason while keyframes are held
  old_mask,          ///< the propagated mask has become too old
  few_close_points,  ///< few close points are tracked, and many new ones could be made
  few_inliers,       ///< the view has changed: few points of the reference keyframe are tracked
  interval,          ///< the last keyframe is long ago, and the view has changed a little
};

/// Decides which tracked frames become keyframes (after Mur-Artal and Tardos 2017, section III-E, with conditions for
/// masks and time). Stateless.
class KeyframePolicy {
 public:
  explicit KeyframePolicy(const TrackingSettings& settings) : settings_(settings) {}

  /// Counts points for a frame that was tracked against a reference keyframe of this map. Leaves
  /// since_last, mask_age and on_hold to the caller. A reference that was removed from the map has no points.
  KeyframeSituation measure(const Frame& frame, int inliers, KeyFrameId reference, const Map& map) const;
  /// The first reason that applies, in the order of KeyframeReason.
  KeyframeReason decide(const KeyframeSituation& situation) const;

 private:
  TrackingSettings settings_;
};

}  // namespace holdfast
