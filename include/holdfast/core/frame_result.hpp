// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/frame_health.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/moving_object.hpp"
#include "holdfast/core/stage_times.hpp"

namespace holdfast {

/// Tracking state of a frame.
enum class TrackingStatus {
  waiting,      ///< there is no map yet, and this frame could not initialise one
  initialised,  ///< this frame initialised the map, or after a loss a new map or submap
  tracked,      ///< the pose was estimated
  lost,         ///< a map exists, but the pose could not be estimated
  inertial,     ///< the images do not determine the pose: it is predicted by inertial measurements
};

/// How the initial pose was estimated, before the refinement against the local map.
enum class TrackingMethod {
  none,
  motion_model,        ///< matches of map points, predicted with constant velocity or by inertial measurements
  reference_keyframe,  ///< descriptor matches with the reference keyframe
  recovered,           ///< after tracking was lost, from one of the last keyframes
  relocalised,         ///< after tracking was lost or in a loaded map, at a place recognised by the loop detector
  flow,                ///< map points of an earlier frame, tracked into this image by optical flow
};

/// Fallback method of a pose that the static features of the frame did not determine.
enum class TrackingFallback {
  none,
  odometry,         ///< frame-to-frame odometry on static features with depth: too little of the map is in view
  masked_features,  ///< features on movable objects are used as well; dense depth must confirm the pose
  dense_depth,      ///< alignment of the depth image with those of keyframes, refined by features if they agree
  inertial,         ///< prediction by inertial measurements, corrected by features if a few of them agree
};

/// Why a frame has no pose.
enum class TrackingFailure {
  none,
  no_depth,
  few_features,
  few_matches,
  few_inliers,
  little_parallax,  ///< the parallax is too small for monocular initialisation
  no_mask,          ///< monocular initialisation waits for the first mask
  weak_start,       ///< the monocular map did not grow after its initialisation and was discarded
  exchanged_pair,   ///< the left and the right image of the stereo pair are swapped
};

const char* to_string(TrackingStatus status);
const char* to_string(TrackingMethod method);
const char* to_string(TrackingFallback fallback);
const char* to_string(TrackingFailure failure);

/// The result of one frame. A frame that cannot be tracked is reported here and never by an exception.
struct FrameResult {
  std::uint64_t index = 0;
  double timestamp = 0.0;
  TrackingStatus status = TrackingStatus::waiting;
  TrackingMethod method = TrackingMethod::none;
  TrackingFallback fallback = TrackingFallback::none;
  TrackingFailure failure = TrackingFailure::none;
  /// The pose as estimated when the frame was processed; empty without one. Later adjustments may correct it
  /// (Pipeline::trajectory).
  std::optional<Eigen::Isometry3d> T_world_camera;
  /// Covariance of the error d of the pose, T_world_camera * exp(d): translation [m] and rotation [rad] in the camera
  /// frame. The error is relative to the map around the camera, that is, to the reference keyframe: drift of the map is
  /// not part of it. From the matches (calibrated_covariance()) or the inertial prediction; empty if unknown.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;
  FrameHealth health;
  int features = 0;         ///< features extracted from the image
  int static_features = 0;  ///< features that are not classified as dynamic
  int matches = 0;          ///< matches with the local map
  int inliers = 0;          ///< inlier matches after motion-only bundle adjustment
  bool is_keyframe = false;
  KeyFrameId keyframe;  ///< the keyframe created from this frame, otherwise the reference keyframe
  /// Moving objects by rising id, if a filter tracks them (`motion_objects`); empty for a lost frame.
  std::vector<MovingObject> objects;
  /// Time from images to pose [s]. It includes the processing of a mask that arrived with this frame, and excludes
  /// decoding and local mapping.
  double tracking_seconds = 0.0;
  StageTimes times;
};

}  // namespace holdfast
