// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/depth_provider.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/inertial_motion.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/relocaliser.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// The modules and data of a Tracker; all of them but the camera must outlive it.
struct TrackerParts {
  const Camera& camera;
  FeatureExtractor& features;
  DepthProvider& depth;
  Optimizer& optimizer;
  LoopDetector& detector;
  MovingWorld& moving_world;
  Map& map;
  std::uint64_t seed = 1;  ///< seed of the random samples of relocalisation
  const FeatureMatcher& matcher = nearest_matcher();
  std::optional<ImuCalibration> imu = {};  ///< frames have inertial measurements
};

/// Data shared by the components of Tracker: the current and the previous frame, and the tools for pose estimation.
/// FrameTracker, the first-pose methods, MapStart and LossRecovery use it within the MapAccess of Tracker, except in
/// Tracker::begin(), which has none. One thread.
struct TrackingContext {
  TrackingContext(const TrackingSettings& settings, const TrackerParts& parts);
  TrackingContext(const TrackingContext&) = delete;
  TrackingContext& operator=(const TrackingContext&) = delete;

  /// T_current_previous by inertial measurements or, without a reliable prediction, by constant velocity.
  Eigen::Isometry3d predicted_step() const;
  /// T_camera_world of the current frame by this step.
  Eigen::Isometry3d predicted_pose() const { return predicted_step() * previous.T_camera_world; }
  /// Time up to which poses can be based on the previous frame without the map [s]; inertial measurements refute those
  /// that moving features determine, so that it is longer with them.
  double odometry_limit() const;
  /// T_current_previous by the poses of both frames.
  Eigen::Isometry3d measured_step() const { return current.T_camera_world * previous.T_world_camera(); }
  /// Time since the last tracked frame [s]; empty if it is more than FrameMotion::longest_interval.
  std::optional<double> interval() const;
  /// The motion T_current_previous = step since the last tracked frame; empty if interval() is.
  std::optional<FrameMotion> motion_by(const Eigen::Isometry3d& step) const;
  /// motion_by() this step, with the rotation at the exposure of the current frame: by the gyroscope if it is reliable,
  /// or else by FrameMotion::at_end() if there is a step before it of about the same length. This changes measured
  /// steps only, since a prediction without inertia repeats the step before.
  std::optional<FrameMotion> motion_at_exposure(const Eigen::Isometry3d& step) const;
  /// Corrects the features of the current frame for motion_at_exposure(step) (FrameBuilder::place_features).
  void place_features(const SensorFrame& sensor_frame, const Eigen::Isometry3d& step, StageTimes& times);
  /// The submap in which the camera is tracked.
  std::uint32_t submap() const { return map.submap_of(reference_keyframe).value_or(0); }
  /// Removes all matches of the current frame with map points.
  void drop_matches();
  /// Resets the data to the state before the first frame.
  void forget_map();

  const TrackingSettings settings;
  MovingWorld& moving_world;
  Map& map;
  DepthProvider& depth;
  const bool features_have_depth;
  bool localises_only = false;  ///< localisation mode: the map is not changed

  FrameBuilder builder;
  FrameHistory history;
  FrameMatcher matcher;
  PoseEstimator estimator;
  Relocaliser relocaliser;
  RollingShutter shutter;
  InertialMotion inertia;

  Frame current, previous;
  KeyFrameId reference_keyframe;   ///< reference keyframe of the current frame
  KeyFrameId last_keyframe;        ///< most recently added keyframe
  double last_feature_time = 0.0;  ///< time of the last pose that was estimated from map matches [s]
};

}  // namespace holdfast
