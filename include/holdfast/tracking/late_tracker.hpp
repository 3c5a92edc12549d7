// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <vector>

#include "holdfast/core/stage_times.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Locates frames without a pose in the finished map: those before a map began, and those of losses that backward
/// tracking did not bridge because the map did not show their view yet. Features are kept, images are not. With one
/// camera all of them count as static: the masks of such frames are often old, and the finished map has no people that
/// they could match. One thread, within a MapAccess.
///
/// A frame is matched with the frame located before it or, if none is near in time, by descriptors with the keyframes
/// nearest in time (PnP with RANSAC); both are followed by the guided search in the local map. It is tried latest first
/// and then earliest first, so that frames are reached from both sides. A pose needs as many inliers as one by place
/// recognition, and must be reachable from the poses around it.
class LateTracker {
 public:
  /// Components used by the tracker; all must outlive it.
  struct Parts {
    Map& map;
    FrameMatcher& matcher;
    PoseEstimator& estimator;
    FrameHistory& history;
  };
  LateTracker(const TrackingSettings& settings, const Parts& parts) : settings_(settings), parts_(parts) {}

  /// Keeps a copy of a frame; only the last TrackingSettings::late_frames are kept.
  void keep(const Frame& frame);
  /// Locates the kept frames that have no pose yet, and forgets all; the others stay without a pose once `stop` is set,
  /// by any thread. Adds the stage "late frames" if there are any.
  void finish(StageTimes& times, const std::atomic<bool>& stop);

  /// Number of frames that received a pose.
  std::size_t located() const { return located_; }

 private:
  /// Locates the frames without a pose in this order, each by the one before it, until `stop`.
  void locate(std::vector<Frame*>& frames, const std::atomic<bool>& stop);
  /// `neighbour`: a frame with a pose close in time, or null.
  bool find_pose(Frame* neighbour, Frame& frame);
  bool match_neighbour(Frame& neighbour, Frame& frame);
  bool match_keyframe(KeyFrameId keyframe, Frame& frame);
  /// Searches the local map from a first pose, and judges the result.
  bool fits_map(Frame& frame);
  /// Whether the motion to the nearest keyframes of its submap is possible.
  bool is_reachable(const Frame& frame) const;

  const TrackingSettings& settings_;
  Parts parts_;
  std::deque<Frame> frames_;  // by rising time
  std::size_t located_ = 0;
  std::vector<OdometryMatch> odometry_;
};

}  // namespace holdfast
