// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/keyframe_policy.hpp"

#include <algorithm>

namespace holdfast {

KeyframeSituation KeyframePolicy::measure(const Frame& frame, int inliers, KeyFrameId reference, const Map& map) const {
  const KeyFrame* const keyframe = map.find_keyframe(reference);
  KeyframeSituation situation{.inliers = inliers,
                              .keyframes = map.keyframes_in(keyframe == nullptr ? 0 : keyframe->submap)};
  // Established points were observed by another keyframe, too, as soon as there is another.
  const std::size_t enough_observations = situation.keyframes <= 2 ? 1 : 2;
  if (keyframe != nullptr)
    for (const MapPointId id : keyframe->frame.map_points)
      if (const MapPoint* point = map.find_point(id); point && point->observations.size() >= enough_observations)
        ++situation.reference_points;
  const float close = static_cast<float>(settings_.close_depth_factor * frame.camera->baseline);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.has_depth(i) || frame.depth[i] > close) continue;
    ++(frame.map_points[i].valid() ? situation.close_tracked : situation.close_untracked);
  }
  return situation;
}

KeyframeReason KeyframePolicy::decide(const KeyframeSituation& s) const {
  if (s.inliers < settings_.minimum_inliers) return KeyframeReason::none;
  if (s.on_hold || s.since_last < settings_.keyframe_minimum_interval)
    return s.inliers < 2 * settings_.minimum_inliers ? KeyframeReason::nearly_lost : KeyframeReason::none;
  if (s.mask_age >= settings_.keyframe_mask_age) return KeyframeReason::old_mask;
  if (s.close_tracked < settings_.keyframe_close_tracked && s.close_untracked > settings_.keyframe_close_possible)
    return KeyframeReason::few_close_points;
  const double ratio = s.keyframes < 2 ? std::min(settings_.keyframe_first_ratio, settings_.keyframe_tracked_ratio)
                                       : settings_.keyframe_tracked_ratio;
  if (s.inliers < ratio * s.reference_points) return KeyframeReason::few_inliers;
  const bool due = s.since_last >= settings_.keyframe_maximum_interval;
  if (due && s.inliers < settings_.keyframe_due_ratio * s.reference_points) return KeyframeReason::interval;
  return KeyframeReason::none;
}

}  // namespace holdfast
