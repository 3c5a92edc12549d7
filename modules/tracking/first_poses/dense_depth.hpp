// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "holdfast/tracking/first_pose.hpp"

namespace holdfast {

/// Alignment of the depth image with those of keyframes, or with what is given, refined by features where they agree,
/// for TrackingSettings::depth_only_time without them.
class DenseDepth final : public FirstPose {
 public:
  explicit DenseDepth(DepthAlignment align = {}) : align_(std::move(align)) {}

  FirstPoseOutcome find(PoseSearch& search) override {
    TrackingContext& context = search.context;
    if (search.situation.was_lost || !context.history.has_previous()) return FirstPoseOutcome::none;
    FrameResult& result = search.result;
    result.fallback = TrackingFallback::dense_depth;
    const Eigen::Isometry3d predicted = context.predicted_pose();
    const auto aligned =
        align_ ? align_(context.current, predicted, result.times)
               : context.moving_world.align_depth(context.current, predicted, context.reference_keyframe, result.times);
    if (!aligned || context.inertia.contradicts(*aligned, 1.0)) return FirstPoseOutcome::none;
    result.method = TrackingMethod::motion_model;
    const TrackingFailure failure = result.failure;
    // The aligned pose is better than a prediction, but not as good as features: a wide search finds them if there are.
    context.current.T_camera_world = *aligned;
    context.drop_matches();
    const double window = context.settings.relocalisation_window * context.settings.local_map_window;
    context.matcher.match_local_map(static_cast<float>(window), context.current);
    context.estimator.adjust(context.current);
    context.estimator.drop_outliers(context.current);
    if (search.local_map.track_local_map(search.view, search.situation, result)) return FirstPoseOutcome::final_pose;
    if (context.current.timestamp > context.last_feature_time + context.settings.depth_only_time)
      return FirstPoseOutcome::none;
    context.current.T_camera_world = *aligned;
    context.drop_matches();
    result.inliers = result.matches = 0;
    result.failure = failure;
    return FirstPoseOutcome::final_pose;
  }

 private:
  DepthAlignment align_;  // none: keyframes
};

}  // namespace holdfast
