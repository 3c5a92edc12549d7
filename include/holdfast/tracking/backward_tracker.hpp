// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Tracks frames that had no pose backwards in time, once a later frame has one: where a camera comes back to the map,
/// the frames right before it see part of the map, too, but only from there is it known where to search. Features,
/// masks and weights of such a frame are kept, its images are not.
///
/// The first of them is tracked from the keyframe that was made when the camera was found, after its mask has had time
/// to arrive, because mapping then has made its points. Where the map does not suffice, a frame is tracked by all
/// static features with depth of the frame after it, for TrackingSettings::odometry_time at most. Every pose must hold
/// as firmly as one after a loss. One thread; LossRecovery calls it within a MapAccess for every frame,
/// and at the end of the run.
///
/// The frames around the start of a map of one camera are kept as well, those before its second view and those that
/// were tracked while bundle adjustment still changed the shape of the map: the pose that a frame gets backwards
/// replaces the one that it had, unless the frame is a keyframe. A frame that gets none keeps the one that it had,
/// unless that contradicts inertia.
class BackwardTracker {
 public:
  /// What it works with; all of it must outlive the object.
  struct Parts {
    Map& map;
    MovingWorld& moving_world;
    FrameMatcher& matcher;
    PoseEstimator& estimator;
    FrameHistory& history;
  };
  BackwardTracker(const TrackingSettings& settings, const Parts& parts) : settings_(settings), parts_(parts) {}

  /// Keeps a copy of a frame that follows all others; only the last `max_count` stay. The frames of an earlier loss
  /// that still wait are tracked first. Adds the stage "backwards" where it tracks.
  void keep(const Frame& frame, int max_count, StageTimes& times);
  /// Tracks all kept frames, because no other frame follows.
  void finish(StageTimes& times);
  /// The frame that was located last became a keyframe.
  void keyframe_added(KeyFrameId keyframe);
  /// Forgets the kept frames.
  void clear();

  /// Goes on with the kept frames, a few of them, latest first; `located` is the frame just tracked. Poses are added to
  /// the history. Adds the stage "backwards" where it tracks.
  void track(const Frame& located, StageTimes& times);

  /// How many frames without a pose have got one.
  std::size_t tracked() const { return tracked_; }
  /// How many frames have lost the pose that they had.
  std::size_t withdrawn() const { return withdrawn_; }

 private:
  /// Sets the frame to begin from, if it is time; `now`: even if points of the keyframe may still come.
  bool begin(bool now);
  void track_kept(int max_count);
  bool find_pose(Frame& frame);
  /// T_camera_world at an earlier time [s] by constant velocity from the anchor.
  Eigen::Isometry3d predicted_pose(double timestamp) const;
  /// The kept frame has got a pose: adds it to the history.
  void add_pose(const Frame& frame);
  /// The kept frame has got no pose: withdraws the one that it had if that contradicts inertia.
  void check_earlier_pose(const Frame& frame);
  /// The pose that was last adjusted is not determined well enough by its inliers, or contradicts the depth of
  /// keyframes or inertia.
  bool is_refuted(const Frame& frame, const Eigen::Isometry3d& predicted, int inliers);

  const TrackingSettings& settings_;
  Parts parts_;
  std::deque<Frame> frames_;      // by rising time
  std::optional<Frame> located_;  // the first frame with a pose after the kept ones
  KeyFrameId keyframe_;           // made of that frame or of one soon after it
  std::uint64_t last_index_ = 0;  // of the frame that was tracked last
  std::vector<TimedPose> after_;  // poses of the frames after located_, T_world_camera
  std::optional<Frame> anchor_;   // the frame with a pose that follows the last kept one
  KeyFrameId reference_;          // of the anchor
  double map_time_ = 0.0;         // of the earliest frame whose pose the map has confirmed [s]
  /// From the anchor's successor to the anchor, backwards in time.
  std::optional<FrameMotion> motion_;
  std::vector<OdometryMatch> odometry_;
  int failures_ = 0;  // in a row
  std::size_t tracked_ = 0, withdrawn_ = 0;
};

}  // namespace holdfast
