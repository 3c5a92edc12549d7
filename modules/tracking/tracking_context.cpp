// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/tracking_context.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/geometry/se3.hpp"

namespace holdfast {

TrackingContext::TrackingContext(const TrackingSettings& given, const TrackerParts& parts)
    : settings(given),
      moving_world(parts.moving_world),
      map(parts.map),
      depth(parts.depth),
      features_have_depth(depth.features_have_depth()),
      builder(parts.camera, parts.features, depth),
      matcher(settings, map, parts.matcher),
      estimator(settings, parts.optimizer, moving_world, map),
      relocaliser(settings, {parts.detector, moving_world, map, matcher, estimator, history}, parts.seed),
      shutter(depth.allows_motion_compensation() ? settings.rolling_shutter : RollingShutterMode::off,
              parts.camera.readout),
      inertia(settings.inertia ? parts.imu : std::nullopt, features_have_depth) {
  if (map.inertia()) inertia.begin_with(*map.inertia());
}

Eigen::Isometry3d TrackingContext::predicted_step() const {
  if (const std::optional<Eigen::Isometry3d> step = inertia.step()) return *step;
  return history.predicted_step(current.timestamp);
}

double TrackingContext::odometry_limit() const {
  return last_feature_time + settings.odometry_time + (inertia.is_reliable() ? settings.inertial_time : 0.0);
}

std::optional<double> TrackingContext::interval() const {
  const double interval = current.timestamp - history.last_timestamp();
  return interval > FrameMotion::longest_interval ? std::nullopt : std::optional(interval);
}

std::optional<FrameMotion> TrackingContext::motion_by(const Eigen::Isometry3d& step) const {
  const std::optional<double> since_previous = interval();
  if (!since_previous) return std::nullopt;
  return FrameMotion{geometry::log_se3(step), *since_previous};
}

std::optional<FrameMotion> TrackingContext::motion_at_exposure(const Eigen::Isometry3d& step) const {
  std::optional<FrameMotion> motion = motion_by(step);
  if (!motion) return motion;
  if (const std::optional<Eigen::Vector3d> rate = inertia.turn_rate()) {
    motion->tangent.tail<3>() = -motion->interval * *rate;  // the world turns against the camera
    return motion;
  }
  // A step of another length says little of how the rotation changes.
  constexpr double longest_ratio = 2.5;
  const double ratio = history.has_velocity() ? motion->interval / history.velocity_interval() : 0.0;
  if (!(ratio <= longest_ratio && ratio * longest_ratio >= 1.0)) return motion;
  return motion->at_end(geometry::log_se3(history.predicted_step(current.timestamp)));
}

void TrackingContext::place_features(const SensorFrame& sensor_frame, const Eigen::Isometry3d& step,
                                     StageTimes& times) {
  constexpr double min_delay = 1e-4;  // s
  const bool aligns_depth = settings.depth_alignment && std::abs(sensor_frame.depth_delay) >= min_delay;
  if (const std::optional<FrameMotion> motion = motion_at_exposure(step))
    builder.place_features(sensor_frame, *motion, aligns_depth, shutter, map, current, times);
}

void TrackingContext::drop_matches() { std::fill(current.map_points.begin(), current.map_points.end(), MapPointId()); }

void TrackingContext::forget_map() {
  history.clear();
  inertia.reset();
  reference_keyframe = last_keyframe = KeyFrameId();
  last_feature_time = 0.0;
}

}  // namespace holdfast
