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

/// Tracks frames without a pose backwards in time after tracking was recovered: the frames right before a recovery
/// often show part of the map as well, and the later pose predicts theirs. Features, masks and weights of such frames
/// are kept, images are not.
///
/// Backward tracking starts at the keyframe created after the recovery, when its mask has had time to arrive and
/// mapping has created its points. If too little of the map is visible, a frame is tracked by odometry on the static
/// features with depth of the frame after it, for at most TrackingSettings::odometry_time. Poses are accepted by the
/// same tests as after a loss. One thread; LossRecovery calls it within a MapAccess for every frame and at the end of
/// the run.
///
/// In monocular mode the frames around the initialisation of a map are kept as well: those before the second view, and
/// those tracked while the map was still deformed by bundle adjustment. Their backward pose replaces the earlier one,
/// except for keyframes. Without a backward pose the earlier one is kept unless it contradicts inertia.
class BackwardTracker {
 public:
  /// Components used by the tracker; all must outlive it.
  struct Parts {
    Map& map;
    MovingWorld& moving_world;
    FrameMatcher& matcher;
    PoseEstimator& estimator;
    FrameHistory& history;
  };
  BackwardTracker(const TrackingSettings& settings, const Parts& parts) : settings_(settings), parts_(parts) {}

  /// Keeps a copy of the newest frame; only the last `max_count` frames are kept. Waiting frames of an earlier loss are
  /// tracked first. Adds the stage "backwards" if it tracks.
  void keep(const Frame& frame, int max_count, StageTimes& times);
  /// Tracks all kept frames at the end of the run.
  void finish(StageTimes& times);
  /// Registers that the last located frame became a keyframe.
  void keyframe_added(KeyFrameId keyframe);
  /// Removes the kept frames.
  void clear();

  /// Tracks some of the kept frames, latest first. `located` is the frame just tracked. Poses are added to the history.
  /// Adds the stage "backwards" if it tracks.
  void track(const Frame& located, StageTimes& times);

  /// Number of frames without a pose that received one.
  std::size_t tracked() const { return tracked_; }
  /// Number of frames whose earlier pose was withdrawn.
  std::size_t withdrawn() const { return withdrawn_; }

 private:
  /// Selects the start frame when its keyframe is complete; `now`: even if points of the keyframe may still be missing.
  /// Returns whether it was selected.
  bool begin(bool now);
  void track_kept(int max_count);
  bool find_pose(Frame& frame);
  /// T_camera_world at an earlier time [s] by constant velocity from the anchor.
  Eigen::Isometry3d predicted_pose(double timestamp) const;
  /// Adds the pose of a kept frame to the history.
  void add_pose(const Frame& frame);
  /// For a kept frame without a backward pose: withdraws its earlier pose if that contradicts inertia.
  void check_earlier_pose(const Frame& frame);
  /// True if the last adjusted pose is too uncertain, or contradicts the depth of keyframes or inertia.
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
