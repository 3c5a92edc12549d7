// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// State of the tracker on which the acceptance of a pose depends.
struct PoseSituation {
  bool was_lost = false;         ///< the previous frame has no pose
  bool may_be_anywhere = false;  ///< a relocalised pose is not limited to the reachable area around the last one
  bool is_unconfirmed = false;   ///< TrackerState::unconfirmed
  double map_age = 0.0;          ///< time since the map was started or restarted [s]; infinite for a loaded map
};

/// Acceptance tests of an adjusted pose: number of inliers, inertia, covariance of the position, agreement with the
/// dense depth of keyframes. Used by FrameTracker and the first-pose methods. Keeps no state. One thread, within the
/// MapAccess of Tracker::locate().
class PoseChecks {
 public:
  /// The context must outlive the object.
  explicit PoseChecks(TrackingContext& context) : context_(context) {}

  /// True for a number of inliers that needs no other check: ample_inliers times TrackingSettings::minimum_inliers.
  bool has_ample_inliers(int inliers) const;
  /// Whether the pose deviates from constant velocity by more than `factor` times jump_distance or jump_angle.
  bool exceeds_acceleration(double factor) const;
  /// True if the pose contradicts the inertial measurements. Ample inliers may differ by twice as much.
  bool contradicts_measured_motion(int inliers) const;
  /// True if the pose contradicts inertia (unless the camera was lost), is too uncertain, or contradicts the depth of
  /// keyframes.
  bool is_refuted(int inliers, bool was_lost) const;
  /// Whether a pose adjusted against the local map is accepted. `result` holds its inliers, static features and method.
  bool accepts(const FrameResult& result, const PoseSituation& situation) const;

 private:
  bool contradicts_motion(int inliers) const;
  bool lacks_support(const FrameResult& result, double map_age) const;

  TrackingContext& context_;
};

}  // namespace holdfast
