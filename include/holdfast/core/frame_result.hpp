// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/id.hpp"
#include "holdfast/core/moving_object.hpp"
#include "holdfast/core/stage_times.hpp"

namespace holdfast {

/// What became of a frame.
enum class TrackingStatus {
  waiting,      ///< no map yet, and this frame could not start one
  initialised,  ///< this frame started the map
  tracked,      ///< pose found
  lost,         ///< a map exists, but no pose was found
};

/// How the pose was first found, before the local map refined it.
enum class TrackingMethod {
  none,
  motion_model,        ///< from the previous frame
  reference_keyframe,  ///< by comparing with the reference keyframe
  recovered,           ///< after a loss, from one of the last keyframes
  relocalised,         ///< after a loss or in a loaded map, at a place that the loop detector recognised
};

/// Why a frame has no pose.
enum class TrackingTrouble { none, no_depth, few_features, few_matches, few_inliers };

const char* to_string(TrackingStatus status);
const char* to_string(TrackingMethod method);
const char* to_string(TrackingTrouble trouble);

/// The typed result of one frame; trouble with a frame is never an exception.
struct FrameResult {
  std::uint64_t index = 0;
  double timestamp = 0.0;
  TrackingStatus status = TrackingStatus::waiting;
  TrackingMethod method = TrackingMethod::none;
  TrackingTrouble trouble = TrackingTrouble::none;
  /// The pose as known when the frame was done; later adjustments may still correct it (Pipeline::trajectory).
  std::optional<Eigen::Isometry3d> T_world_camera;
  int features = 0;         ///< found in the image
  int static_features = 0;  ///< of those, not judged dynamic
  int matches = 0;          ///< with the local map
  int inliers = 0;          ///< of those, after the motion-only adjustment
  bool is_keyframe = false;
  KeyFrameId keyframe;            ///< the keyframe made of this frame, or the reference keyframe
  /// What moves or has moved, in the order of ids, when a filter tracks it (`motion_objects`); empty for a lost frame.
  std::vector<MovingObject> objects;
  double tracking_seconds = 0.0;  ///< from the images to the pose: all but decoding them and local mapping
  StageTimes times;
};

}  // namespace holdfast
