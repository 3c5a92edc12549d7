// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/tracking/first_pose.hpp"
#include "holdfast/tracking/rival_motion.hpp"

namespace holdfast {

/// Matches of the previous frame's map points, predicted with constant velocity.
inline bool predict_by_motion_model(PoseSearch& search) {
  TrackingContext& context = search.context;
  if (!context.history.has_previous()) return false;
  const TrackingSettings& settings = context.settings;
  const Eigen::Isometry3d predicted = context.predicted_pose();
  const float window = static_cast<float>(settings.motion_window);
  for (const float radius : {window, static_cast<float>(settings.motion_window_retry) * window}) {
    context.current.T_camera_world = predicted;
    if (context.matcher.match_previous(context.previous, radius, context.current) < settings.minimum_matches) continue;
    const int inliers = context.estimator.adjust(context.current);
    context.estimator.drop_outliers(context.current);
    if (inliers >= settings.minimum_matches / 2) {
      search.result.method = TrackingMethod::motion_model;
      return true;
    }
  }
  search.result.failure = TrackingFailure::few_matches;
  return false;
}

/// Descriptor matches with the reference keyframe.
inline bool predict_by_reference_keyframe(PoseSearch& search) {
  TrackingContext& context = search.context;
  const auto start = context.history.has_previous() ? std::optional(context.previous.T_camera_world) : std::nullopt;
  return context.relocaliser.align_with_keyframe(context.reference_keyframe, start, context.current, search.result);
}

/// One of the two, for a camera that was tracked until now.
class Prediction final : public FirstPose {
 public:
  explicit Prediction(bool (*predict)(PoseSearch&)) : predict_(predict) {}
  FirstPoseOutcome find(PoseSearch& search) override {
    if (search.situation.was_lost || search.is_predicted) return FirstPoseOutcome::none;
    const StageTimer timer(search.result.times, "predict");
    search.is_predicted = predict_(search);
    const TrackingContext& context = search.context;
    if (search.is_predicted && context.map.sensor() == Sensor::stereo && !context.history.has_velocity())
      test_start_motion(search.context);
    return search.is_predicted ? FirstPoseOutcome::first_pose : FirstPoseOutcome::none;
  }

 private:
  bool (*predict_)(PoseSearch&);
};

}  // namespace holdfast
