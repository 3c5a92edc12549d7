// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/frame_result.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/pose_checks.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Second step of tracking a frame (Mur-Artal et al. 2015, section V-D): refines an initial pose by matches with the
/// local map, after the filters that need a pose. FrameTracker calls it for every initial pose. Keeps no state. One
/// thread, within the MapAccess of Tracker::locate().
class LocalMapRefinement {
 public:
  /// The context must outlive the object.
  explicit LocalMapRefinement(TrackingContext& context) : context_(context), checks_(context) {}

  /// Refines the initial pose of the current frame. False if the pose is rejected.
  bool refine(TrackedView& view, const PoseSituation& situation, FrameResult& result) const;
  /// Last part of refine(): matches the local map, adjusts the pose, and accepts or rejects it.
  bool track_local_map(const TrackedView& view, const PoseSituation& situation, FrameResult& result) const;
  /// Runs the filters that need a pose and adjusts again.
  void evaluate_with_pose(const TrackedView& view, FrameResult& result) const;
  /// Counts the matches of the last adjustment and the static features.
  void count_matches(FrameResult& result) const;

  const PoseChecks& checks() const { return checks_; }

 private:
  TrackingContext& context_;
  PoseChecks checks_;
};

}  // namespace holdfast
