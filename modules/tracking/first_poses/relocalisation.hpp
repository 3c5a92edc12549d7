// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/tracking/first_pose.hpp"

namespace holdfast {

/// Relocaliser, for a lost camera, or one whose pose cannot be predicted at all.
class Relocalisation final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    if (!search.situation.was_lost && search.is_predicted) return FirstPoseOutcome::none;
    TrackingContext& context = search.context;
    const StageTimer timer(search.result.times, "relocalisation");
    return context.relocaliser.relocalise(context.last_keyframe, context.reference_keyframe,
                                          search.view.sensor_frame.colour, context.current, search.result)
               ? FirstPoseOutcome::first_pose
               : FirstPoseOutcome::none;
  }
};

}  // namespace holdfast
