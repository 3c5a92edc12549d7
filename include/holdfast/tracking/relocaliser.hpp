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
#include "holdfast/interfaces/place_weights.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Components used by a Relocaliser; all must outlive it.
struct RelocaliserParts {
  LoopDetector& detector;
  const MovingWorld& moving_world;
  const Map& map;
  FrameMatcher& matcher;
  PoseEstimator& estimator;
  FrameHistory& history;
};

/// Relocalisation of a frame after a loss: by extrapolation of the last velocity, by descriptor matches with the last
/// keyframes, or by place recognition. Each function sets pose and matches of the frame and, in the result, the method
/// or the failure. Random samples depend on the seed only. One thread, within a MapAccess.
class Relocaliser {
 public:
  Relocaliser(const TrackingSettings& settings, const RelocaliserParts& parts, std::uint64_t seed)
      : settings_(settings),
        parts_(parts),
        weights_(parts.detector, parts.moving_world.classes()),
        random_(Random(seed).fork(1)) {}

  /// Matches the frame with one keyframe by descriptors, aligns its 3-D points with the map by RANSAC, and optimizes
  /// the pose. Without an alignment the initial value is `start` or, if empty, the pose of the keyframe.
  bool align_with_keyframe(KeyFrameId keyframe, const std::optional<Eigen::Isometry3d>& start, Frame& frame,
                           FrameResult& result);
  /// Tries coast(), recover() and find_place() in this order. `image` is the frame's colour image.
  bool relocalise(KeyFrameId last_keyframe, KeyFrameId reference, const cv::Mat& image, Frame& frame,
                  FrameResult& result);

  /// Guided search in the local map at poses extrapolated by fractions of the last velocity, for a short time after the
  /// loss.
  bool coast(Frame& frame, FrameResult& result);
  /// Tries align_with_keyframe() with the last keyframe and the strongest covisible neighbours of it and of the
  /// reference keyframe.
  bool recover(KeyFrameId last_keyframe, KeyFrameId reference, Frame& frame, FrameResult& result);
  /// Relocalisation by place recognition: candidates of the loop detector, PnP with RANSAC, guided search in the local
  /// map (Mur-Artal et al. 2015, section V-C). Computes the global image descriptor first if the detector uses one.
  bool find_place(const cv::Mat& image, Frame& frame, FrameResult& result);
  /// Whether the inliers of the last adjustment are too many for a chance result. In monocular mode this depends on
  /// their share of the matches; with depth it is always true.
  bool is_beyond_chance(int inliers) const;
  /// Whether the frame's pose is reachable from the last tracked one at TrackingSettings::relocalisation_speed, plus a
  /// `tolerance` [m] for errors of the last pose.
  bool is_reachable(const Frame& frame, double tolerance) const;

 private:
  bool fits_surroundings(Frame& frame, FrameResult& result);
  int search_local_map(double window, Frame& frame);
  std::vector<PlaceMatch> similar_places(const Frame& frame, bool of_image) const;

  TrackingSettings settings_;
  RelocaliserParts parts_;
  PlaceWeights weights_;  // for the labels of the segmenter
  Random random_;
};

}  // namespace holdfast
