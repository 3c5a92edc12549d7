// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/backward_tracker.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/map_request.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Decides what follows a loss: poses on which few inliers agree stay unconfirmed and may be withdrawn; a camera that
/// is lost for long begins a new submap and returns from it; frames without a pose are tracked backwards. Tracker calls
/// it for every frame with a map, in its thread and within its MapAccess.
class LossRecovery {
 public:
  /// Both must outlive the object.
  LossRecovery(TrackingContext& context, const LocalMapRefinement& local_map);

  /// Whether the camera was lost so soon after the map began, at `map_start` [s], that waiting for a known view is not
  /// worth it: with a first keyframe on people, next to nothing of the map may be left.
  bool was_lost_at_start(double map_start) const;
  /// Whether the camera has been lost for TrackingSettings::restart_time, and a mask is fresh if masks are expected.
  bool should_begin_submap() const;
  /// T_camera_world of a lost camera by constant velocity; after the coasting time, its last known pose.
  Eigen::Isometry3d coasting_pose() const;
  /// The current frame begins a map, or begins it anew.
  void map_begun() { unconfirmed_.reset(); }
  /// It begins a submap; `may_return`: the keyframes by which the camera was lost are remembered, to return there.
  void submap_begun(bool may_return);
  /// Whether the camera is in a submap that it may return from.
  bool may_return() const { return left_reference_.valid(); }
  /// Relocalises a tracked camera where it was lost before it began a submap, and goes on there if that succeeds.
  void try_to_return(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  /// After the search for a pose: a pose found after a loss on which few inliers agree has to be confirmed by those
  /// that follow; if the camera is lost before, it and the poses since are withdrawn.
  void confirm(bool found, bool was_lost, int inliers);
  /// Whether poses since the last loss are not confirmed yet.
  bool is_unconfirmed() const { return unconfirmed_.has_value(); }
  /// Whether the camera was found less than 0.5 s ago, before a mask made since then can have arrived.
  bool was_just_found() const;
  /// Whether a mask would help to find the camera.
  bool wants_mask(TrackerState state) const;

  /// Keeps the current frame to track it backwards; only the last `count` stay.
  void keep_frame(int count, StageTimes& times) { backwards_.keep(context_.current, count, times); }
  void forget_frames() { backwards_.clear(); }
  /// Tracks some of the kept frames backwards from the current one, which has a pose.
  void track_backwards(StageTimes& times) { backwards_.track(context_.current, times); }
  void keyframe_added(KeyFrameId keyframe) { backwards_.keyframe_added(keyframe); }
  /// The map was removed.
  void forget_map() { unconfirmed_.reset(); }
  /// No frame follows: withdraws unconfirmed poses and tracks all kept frames.
  void finish(StageTimes& times);
  LossRecord record() const;

 private:
  void withdraw();

  struct Unconfirmed {
    FrameHistory::Mark before;
    int frames = 1;
  };

  TrackingContext& context_;
  const LocalMapRefinement& local_map_;
  BackwardTracker backwards_;
  /// The last and the reference keyframe when the camera was lost before it began a submap; invalid if it did not.
  KeyFrameId left_keyframe_, left_reference_;
  std::optional<Unconfirmed> unconfirmed_;
  std::optional<double> found_time_;  // after the last loss [s]
  std::size_t withdrawn_ = 0;         // frames
  std::size_t submaps_ = 0;
};

}  // namespace holdfast
