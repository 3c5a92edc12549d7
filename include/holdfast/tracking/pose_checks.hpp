// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Facts about the tracker's state on which the acceptance of a pose depends.
struct PoseSituation {
  bool was_lost = false;         ///< no pose of the previous frame predicts this one
  bool may_be_anywhere = false;  ///< a relocalised pose need not be within reach of the last known one
  bool is_unconfirmed = false;   ///< TrackerState::unconfirmed
  double map_age = 0.0;          ///< since the map began or began anew [s]; infinite for a loaded map
};

/// Acceptance tests of an adjusted pose: number of inliers, inertia, covariance of the position, agreement with the
/// dense depth of keyframes. FrameTracker and the first-pose methods ask for each frame. Keeps no state. One thread,
/// within the MapAccess of Tracker::locate().
class PoseChecks {
 public:
  /// The context must outlive the object.
  explicit PoseChecks(TrackingContext& context) : context_(context) {}

  /// Whether so many inliers need no other support: four times TrackingSettings::minimum_inliers.
  bool has_ample_inliers(int inliers) const;
  /// Whether the pose is more than `factor` times jump_distance or jump_angle from constant velocity.
  bool exceeds_acceleration(double factor) const;
  /// Whether the pose contradicts inertial measurements. Ample inliers may differ by twice as much.
  bool contradicts_measured_motion(int inliers) const;
  /// Whether the pose contradicts inertia (unless the camera was lost), is not determined well enough by its inliers,
  /// or contradicts the depth of keyframes.
  bool is_refuted(int inliers, bool was_lost) const;
  /// Whether a pose adjusted against the local map is final. `result` has its inliers, static features and method.
  bool accepts(const FrameResult& result, const PoseSituation& situation) const;

 private:
  bool contradicts_motion(int inliers) const;
  bool lacks_support(const FrameResult& result, double map_age) const;

  TrackingContext& context_;
};

}  // namespace holdfast
