// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cstddef>
#include <optional>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/tracking/backward_tracker.hpp"
#include "holdfast/tracking/late_tracker.hpp"
#include "holdfast/tracking/local_map_refinement.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/map_request.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Recovery from tracking losses: poses with few inliers remain unconfirmed and may be withdrawn; after a long loss a
/// new submap begins, which is left when the camera is relocalised in the old one; frames without a pose are tracked
/// backwards. Called by Tracker for every frame with a map, in its thread and within its MapAccess.
class LossRecovery {
 public:
  /// Both must outlive the object.
  LossRecovery(TrackingContext& context, const LocalMapRefinement& local_map);

  /// True if the camera was lost so soon after the start of the map at `map_start` [s] that the map should be
  /// restarted: if its first keyframe shows mostly people, hardly any points remain.
  bool was_lost_at_start(double map_start) const;
  /// True if the camera has been lost for TrackingSettings::restart_time and, with a segmenter, a recent mask is
  /// available.
  bool should_begin_submap() const;
  /// T_camera_world of a lost camera by constant velocity; after the coasting time, its last known pose.
  Eigen::Isometry3d coasting_pose() const;
  /// Registers that the current frame starts or restarts the map.
  void map_begun() { unconfirmed_.reset(); }
  /// Registers that the current frame starts a submap. `may_return`: the keyframes where tracking was lost are kept for
  /// try_to_return().
  void submap_begun(bool may_return);
  /// True if the camera is in a submap and may be relocalised in the earlier one.
  bool may_return() const { return left_reference_.valid(); }
  /// Tries to relocalise the camera at the keyframes where tracking was lost before the submap. On success tracking
  /// continues there.
  void try_to_return(TrackedView& view, const PoseSituation& situation, FrameResult& result);

  /// Updates the confirmation state after the pose search: a pose with few inliers after a loss must be confirmed by
  /// later frames. If the camera is lost before, all unconfirmed poses are withdrawn.
  void confirm(bool found, bool was_lost, int inliers);
  /// True if the poses since the last loss are not confirmed yet.
  bool is_unconfirmed() const { return unconfirmed_.has_value(); }
  /// True for 0.5 s after a recovery, until the mask of a frame after it can have arrived.
  bool was_just_found() const;
  /// True if a mask of the current frame would help relocalisation.
  bool wants_mask(TrackerState state) const;

  /// Keeps the current frame for backward tracking; only the last `count` frames are kept.
  void keep_frame(int count, StageTimes& times) { backwards_.keep(context_.current, count, times); }
  /// Keeps the current frame, which has no pose, for the end of the run.
  void keep_late_frame() { late_.keep(context_.current); }
  void forget_frames() { backwards_.clear(); }
  /// Tracks some of the kept frames backwards; the current frame must have a pose.
  void track_backwards(StageTimes& times) { backwards_.track(context_.current, times); }
  void keyframe_added(KeyFrameId keyframe) { backwards_.keyframe_added(keyframe); }
  /// Resets the state after the map was removed.
  void forget_map() { unconfirmed_.reset(); }
  /// Ends the run: withdraws unconfirmed poses, tracks all kept frames backwards, and, until `stop`, locates those that
  /// are left.
  void finish(StageTimes& times, const std::atomic<bool>& stop);
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
  LateTracker late_;
  /// Last and reference keyframe at the loss before the current submap; invalid without such a submap.
  KeyFrameId left_keyframe_, left_reference_;
  std::optional<Unconfirmed> unconfirmed_;
  std::optional<double> found_time_;  // time of the recovery after the last loss [s]
  std::size_t withdrawn_ = 0;         // frames
  std::size_t submaps_ = 0;
};

}  // namespace holdfast
