// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/local_map_refinement.hpp"

#include <algorithm>

#include "holdfast/tracking/rival_motion.hpp"

namespace holdfast {

bool LocalMapRefinement::refine(TrackedView& view, const PoseSituation& situation, FrameResult& result) const {
  const bool has_previous = context_.history.has_previous();
  if (!has_previous) view.previous = nullptr;  // relocalisation gives the previous frame up
  // The measured motion replaces the predicted one.
  if (has_previous) context_.place_features(view.sensor_frame, context_.measured_step(), result.times);
  evaluate_with_pose(view, result);
  return track_local_map(view, situation, result);
}

bool LocalMapRefinement::track_local_map(const TrackedView& view, const PoseSituation& situation,
                                         FrameResult& result) const {
  Frame& frame = context_.current;
  {
    const StageTimer timer(result.times, "local map");
    const Eigen::Isometry3d began = frame.T_camera_world;
    context_.matcher.match_local_map(static_cast<float>(context_.settings.local_map_window), frame);
    result.inliers = context_.estimator.adjust(frame);
    if (context_.map.sensor() == Sensor::stereo && test_local_motion(context_, began))
      result.inliers = context_.estimator.adjust(frame);
  }
  if (result.inliers >= context_.settings.minimum_inliers &&
      context_.moving_world.evaluate(FilterStage::after_matching, view, result.times))
    result.inliers = context_.estimator.adjust(frame);
  const StageTimer timer(result.times, "local map");
  count_matches(result);
  context_.estimator.drop_outliers(frame);
  context_.matcher.local_map().count_found(frame);
  if (!checks_.accepts(result, situation)) {
    result.failure = TrackingFailure::few_inliers;
    return false;
  }
  result.covariance = context_.estimator.covariance();
  context_.moving_world.accumulate(frame);
  context_.reference_keyframe = context_.matcher.local_map().reference_keyframe();
  return true;
}

void LocalMapRefinement::evaluate_with_pose(const TrackedView& view, FrameResult& result) const {
  if (!context_.moving_world.has(FilterStage::with_pose)) return;
  Frame& frame = context_.current;
  if (context_.history.has_velocity()) {
    const PosePrediction prediction{context_.predicted_pose(), context_.previous.T_world_camera()};
    context_.moving_world.check_pose(prediction, context_.reference_keyframe, frame, result.times);
  }
  context_.moving_world.evaluate(FilterStage::with_pose, view, result.times);
  const Eigen::Isometry3d evaluated_with = frame.T_camera_world;
  if (context_.estimator.adjust(frame) < context_.settings.minimum_matches / 2) frame.T_camera_world = evaluated_with;
  context_.estimator.drop_outliers(frame);
}

void LocalMapRefinement::count_matches(FrameResult& result) const {
  const auto& probability = context_.current.static_probability;
  result.matches = context_.estimator.matches();
  result.static_features =
      static_cast<int>(std::count_if(probability.begin(), probability.end(), [](float p) { return is_static(p); }));
}

}  // namespace holdfast
