// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "prediction.hpp"

namespace holdfast {

/// The predictions again, with features on masks of movable classes as well; dense depth has to confirm the pose.
class MaskedFeatures final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    TrackingContext& context = search.context;
    if (search.situation.was_lost || !context.history.has_previous() || !context.moving_world.discount_priors())
      return FirstPoseOutcome::none;
    search.result.fallback = TrackingFallback::masked_features;
    const StageTimer timer(search.result.times, "predict");
    return predict_by_motion_model(search) || predict_by_reference_keyframe(search) ? FirstPoseOutcome::first_pose
                                                                                    : FirstPoseOutcome::none;
  }
};

}  // namespace holdfast
