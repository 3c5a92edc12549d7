// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "holdfast/tracking/first_pose.hpp"

namespace holdfast {

/// Factor on TrackingSettings::local_map_window for a search around an inertial prediction: three standard deviations
/// of a pixel at the typical depth of a room.
inline double inertial_window(const TrackingContext& context, const InertialPrediction& prediction) {
  constexpr double typical_depth = 2.0;  // [m]
  constexpr double window = 2.5;         // [px], of points seen frontally
  const double deviation =
      context.current.camera->fx * (prediction.rotation_deviation + prediction.position_deviation / typical_depth);
  return std::clamp(3.0 * deviation / (window * context.settings.local_map_window), 1.0,
                    context.settings.coasting_window);
}

/// Matches of the local map around the pose that inertial measurements predict, or else of the keyframe with the most
/// similar view: where the previous frame has no matches, as after a view that people hid, and after a loss.
class InertialSearch final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    TrackingContext& context = search.context;
    const std::optional<InertialPrediction> prediction = context.inertia.prediction();
    if (!prediction) return FirstPoseOutcome::none;
    const StageTimer timer(search.result.times, "inertia");
    if (!match_local_map(context, *prediction) && !match_nearest_keyframe(search, *prediction)) {
      search.result.failure = TrackingFailure::few_matches;
      return FirstPoseOutcome::none;
    }
    search.result.method = search.situation.was_lost ? TrackingMethod::recovered : TrackingMethod::motion_model;
    return FirstPoseOutcome::first_pose;
  }

 private:
  static bool match_local_map(TrackingContext& context, const InertialPrediction& prediction) {
    const double window = inertial_window(context, prediction) * context.settings.local_map_window;
    context.current.T_camera_world = prediction.T_camera_world;
    context.drop_matches();
    context.matcher.match_local_map(static_cast<float>(window), context.current);
    const int inliers = context.estimator.adjust(context.current);
    context.estimator.drop_outliers(context.current);
    return inliers >= context.settings.minimum_matches / 2;
  }

  static bool match_nearest_keyframe(PoseSearch& search, const InertialPrediction& prediction) {
    TrackingContext& context = search.context;
    const KeyFrameId nearest = nearest_keyframe(context, prediction.T_camera_world);
    return nearest.valid() && nearest != context.matcher.local_map().reference_keyframe() &&
           context.relocaliser.align_with_keyframe(nearest, prediction.T_camera_world, context.current, search.result);
  }

  /// The keyframe of the submap whose view differs least from a pose: one metre counts as one radian.
  static KeyFrameId nearest_keyframe(const TrackingContext& context, const Eigen::Isometry3d& T_camera_world) {
    constexpr double largest_difference = 1.0;
    const Eigen::Isometry3d T_world_camera = T_camera_world.inverse();
    KeyFrameId nearest;
    double smallest = largest_difference;
    for (const KeyFrameId id : context.map.keyframes_by_age()) {
      const KeyFrame& keyframe = context.map.keyframe(id);
      if (keyframe.submap != context.submap()) continue;
      const Eigen::Isometry3d T_keyframe_camera = keyframe.frame.T_camera_world * T_world_camera;
      const double difference =
          T_keyframe_camera.translation().norm() + Eigen::AngleAxisd(T_keyframe_camera.linear()).angle();
      if (difference < smallest) smallest = difference, nearest = id;
    }
    return nearest;
  }
};

/// Matches with the last keyframes without a prediction, once views that were bridged for long have made the prediction
/// too uncertain to search the map around it: before odometry begins new map at a pose that has drifted.
class InertialReturn final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    constexpr double uncertain = 0.02;  // standard deviation of the position [m]
    TrackingContext& context = search.context;
    const std::optional<InertialPrediction> prediction = context.inertia.prediction();
    if (!prediction || search.situation.was_lost || !context.features_have_depth ||
        prediction->position_deviation < uncertain)
      return FirstPoseOutcome::none;
    const StageTimer timer(search.result.times, "inertia");
    return context.relocaliser.recover(context.last_keyframe, context.reference_keyframe, context.current,
                                       search.result)
               ? FirstPoseOutcome::first_pose
               : FirstPoseOutcome::none;
  }
};

/// The pose that inertial measurements predict, for TrackingSettings::inertial_time and up to inertial_deviation where
/// the images do not determine one. A few matches near it correct it by their covariance.
class InertialBridge final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    TrackingContext& context = search.context;
    const PoseSituation& situation = search.situation;
    std::optional<InertialPrediction> prediction = context.inertia.prediction();
    if (!prediction || situation.was_lost || situation.is_unconfirmed || !context.history.has_previous() ||
        prediction->position_deviation > context.settings.inertial_deviation ||
        context.current.timestamp > context.last_feature_time + context.settings.inertial_time)
      return FirstPoseOutcome::none;
    const StageTimer timer(search.result.times, "inertia");
    if (agrees_with_matches(context, *prediction)) prediction = context.inertia.prediction();
    FrameResult& result = search.result;
    context.current.T_camera_world = prediction->T_camera_world;
    context.drop_matches();
    result.inliers = result.matches = 0;
    result.method = TrackingMethod::motion_model;
    result.fallback = TrackingFallback::inertial;
    result.covariance = prediction->covariance;
    return FirstPoseOutcome::final_pose;
  }

 private:
  static bool agrees_with_matches(TrackingContext& context, const InertialPrediction& prediction) {
    constexpr int fewest_inliers = 15;
    const double window = inertial_window(context, prediction) * context.settings.local_map_window;
    context.current.T_camera_world = prediction.T_camera_world;
    context.drop_matches();
    context.matcher.match_local_map(static_cast<float>(window), context.current);
    return context.estimator.adjust(context.current) >= fewest_inliers && context.estimator.covariance() &&
           context.inertia.correct(context.current.T_camera_world, *context.estimator.covariance(), false);
  }
};

}  // namespace holdfast
