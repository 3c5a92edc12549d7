// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/tracking/first_pose.hpp"

namespace holdfast {

/// Visual odometry: the pose relative to the previous frame, whose static features with depth stand in for the map. A
/// camera that swings to an unknown view among people has nothing else until the mask of the next keyframe is there.
class Odometry final : public FirstPose {
 public:
  FirstPoseOutcome find(PoseSearch& search) override {
    const TrackingContext& context = search.context;
    if (search.situation.was_lost || !context.history.has_previous() ||
        context.current.timestamp > context.odometry_limit())
      return FirstPoseOutcome::none;
    const StageTimer timer(search.result.times, "odometry");
    const TrackingFailure failure = search.result.failure;
    if (!match(search.context)) return FirstPoseOutcome::none;
    const int inliers = adjust(search);
    if (!is_accepted(search, inliers)) return FirstPoseOutcome::none;
    // Where the map ends, the camera would be lost before long; a pose as certain as this begins new map.
    constexpr int certain_inliers = 8;          // times minimum_inliers
    constexpr double certain_deviation = 0.25;  // of maximum_deviation
    search.extends_map =
        inliers >= certain_inliers * context.settings.minimum_inliers &&
        context.estimator.position_deviation() <= certain_deviation * context.settings.maximum_deviation;
    write_result(context, search.result);
    search.result.failure = failure;
    context.moving_world.accumulate(context.current);
    return FirstPoseOutcome::final_pose;
  }

 private:
  bool match(TrackingContext& context) {
    const TrackingSettings& settings = context.settings;
    const Eigen::Isometry3d predicted = context.predicted_pose();
    const float window = static_cast<float>(settings.motion_window);
    for (const float radius : {window, static_cast<float>(settings.motion_window_retry) * window}) {
      context.current.T_camera_world = predicted;
      if (context.matcher.match_previous_features(context.previous, radius, context.current, matches_) >=
              settings.minimum_matches &&
          context.estimator.adjust(context.current, matches_) >= settings.minimum_matches)
        return true;
    }
    return false;
  }

  int adjust(PoseSearch& search) {
    TrackingContext& context = search.context;
    context.moving_world.evaluate(FilterStage::with_pose, search.view, search.result.times);
    context.estimator.adjust(context.current, matches_);
    context.matcher.match_local_map(static_cast<float>(context.settings.local_map_window), context.current);
    return context.estimator.adjust(context.current, matches_);
  }

  static bool is_accepted(const PoseSearch& search, int inliers) {
    const TrackingContext& context = search.context;
    const PoseChecks& checks = search.local_map.checks();
    // Points of one frame are less certain than those of the map: twice as many have to agree. They may all be on one
    // person, who hides the room: however many they are, no camera jumps.
    constexpr double impossible = 3.0;  // times jump_distance and jump_angle
    return inliers >= 2 * context.settings.minimum_inliers && !checks.is_refuted(inliers, false) &&
           !checks.exceeds_acceleration(impossible) &&
           !context.moving_world.is_view_filled(context.current, context.reference_keyframe);
  }

  static void write_result(const TrackingContext& context, FrameResult& result) {
    result.method = TrackingMethod::motion_model;
    result.covariance = context.estimator.covariance();
    result.fallback = TrackingFallback::odometry;
    result.matches = context.estimator.matches();
    result.inliers = result.static_features = 0;
    for (std::size_t i = 0; i < context.current.size(); ++i) {
      if (!is_static(context.current, i)) continue;
      ++result.static_features;
      result.inliers += context.current.map_points[i].valid() ? 1 : 0;
    }
  }

  std::vector<OdometryMatch> matches_;
};

}  // namespace holdfast
