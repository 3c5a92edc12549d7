// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/keyframe_decision.hpp"

namespace holdfast {

bool KeyframeDecision::is_due(const FrameResult& result) const {
  if (context_.localises_only) return false;
  // Frames that are tracked by the previous one keep their reference, which mapping may have removed since.
  const bool is_kept = context_.map.find_keyframe(context_.reference_keyframe) != nullptr;
  const KeyFrameId reference =
      is_kept ? context_.reference_keyframe : context_.matcher.local_map().reference_keyframe();
  KeyframeSituation situation = policy_.measure(context_.current, result.inliers, reference, context_.map);
  situation.since_last = context_.current.timestamp - last_time_;
  situation.mask_age = context_.moving_world.mask_age();
  situation.on_hold = context_.moving_world.holds_keyframes();
  return policy_.decide(situation) != KeyframeReason::none;
}

}  // namespace holdfast
