// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// What a Relocaliser works with; all of it must outlive the Relocaliser.
struct RelocaliserParts {
  LoopDetector& detector;
  const MovingWorld& moving_world;
  const Map& map;
  FrameMatcher& matcher;
  PoseEstimator& estimator;
  FrameHistory& history;
};

/// Finds the pose of a frame without the motion model's prediction: along the last velocity, from keyframes by
/// descriptors, or at places that the loop detector recognises. Each function sets the frame's pose and matches and, in
/// the result, the method when it succeeds or the failure when it does not. Random samples come from the seed. One
/// thread, within a MapAccess.
class Relocaliser {
 public:
  Relocaliser(const TrackingSettings& settings, const RelocaliserParts& parts, std::uint64_t seed)
      : settings_(settings), parts_(parts), random_(Random(seed).fork(1)) {}

  /// Matches the frame with one keyframe by descriptors, aligns depth with the map by RANSAC, and adjusts. When depth
  /// gives no alignment, the adjustment starts at `start`, or at the keyframe's pose without one.
  bool align_with_keyframe(KeyFrameId keyframe, const std::optional<Eigen::Isometry3d>& start, Frame& frame,
                           FrameResult& result);
  /// All hypotheses for a lost camera, in this order: coast(), recover(), find_place(). `image` is the frame's colour
  /// image.
  bool relocalise(KeyFrameId last_keyframe, KeyFrameId reference, const cv::Mat& image, Frame& frame,
                  FrameResult& result);

  /// For a short time after the last tracked frame: searches the local map at shares of the last velocity's motion.
  bool coast(Frame& frame, FrameResult& result);
  /// Tries the last keyframe and the strongest neighbours of it and of the reference keyframe.
  bool recover(KeyFrameId last_keyframe, KeyFrameId reference, Frame& frame, FrameResult& result);
  /// Candidates by appearance, PnP with RANSAC, then guided search in the local map (Mur-Artal et al. 2015, section
  /// V-C). Describes the image first if the loop detector compares whole images.
  bool find_place(const cv::Mat& image, Frame& frame, FrameResult& result);
  /// Whether so many inliers of the last adjustment tell a pose from a wrong one. Depth does so for other sensors;
  /// with one camera, their share of the matches must.
  bool is_beyond_chance(int inliers) const;
  /// Whether the camera can have moved to the frame's pose since it was last tracked, at
  /// TrackingSettings::relocalisation_speed; `tolerance` [m] is for a last pose that had gone astray.
  bool is_reachable(const Frame& frame, double tolerance) const;

 private:
  bool fits_surroundings(Frame& frame, FrameResult& result);
  int search_local_map(double window, Frame& frame);

  TrackingSettings settings_;
  RelocaliserParts parts_;
  Random random_;
};

}  // namespace holdfast
