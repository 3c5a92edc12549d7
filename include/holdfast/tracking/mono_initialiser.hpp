// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

namespace geometry {
struct PixelPair;
struct TwoViewMotion;
}  // namespace geometry

/// Result of two-view initialisation: the initial points and the earlier view, whose camera frame is the world frame.
/// The median depth of the points is TrackingSettings::start_depth.
struct TwoViewMap {
  /// A triangulated point and its features in both views.
  struct Point {
    Eigen::Vector3d position;  ///< world
    std::uint32_t in_reference = 0, in_frame = 0;
  };
  Frame reference;  ///< the earlier view
  std::vector<Point> points;
};

/// Monocular map initialisation (Mur-Artal et al. 2015, section IV): static features of a frame are matched with those
/// of a reference frame, the relative pose is estimated by find_two_view_motion(), and both poses and the points are
/// refined by bundle adjustment. A frame with too few matches becomes the new reference. One thread.
class MonoInitialiser {
 public:
  /// The optimizer and the matcher must outlive the initialiser. Random samples come from the seed.
  MonoInitialiser(const TrackingSettings& settings, Optimizer& optimizer, std::uint64_t seed,
                  const FeatureMatcher& matcher = nearest_matcher())
      : settings_(settings), optimizer_(optimizer), matcher_(matcher), random_(Random(seed).fork(2)) {}

  /// Tries to initialise the map with a frame whose features are weighted (Frame::static_probability). On success the
  /// frame's pose is set, start() holds the other view and the points, and TrackingFailure::none is returned.
  TrackingFailure add(Frame& frame);

  /// Valid after add() returned no failure, until the next call.
  const TwoViewMap& start() const { return start_; }
  /// Discards the reference; the next frame becomes the new one.
  void forget() { has_reference_ = false; }

 private:
  void take_reference(const Frame& frame);
  /// Matches features of the frame with the static ones of the reference.
  void match(const Frame& frame, const std::vector<std::uint32_t>& features);
  /// Whether the points of start() determine the direction of the motion (TrackingSettings::start_deviation). Entry i
  /// of `pairs` belongs to matches_[i].
  bool is_certain(const std::vector<geometry::PixelPair>& pairs, const Frame& frame) const;
  /// Bundle adjustment of both poses and the points, and scaling to start_depth. False if too few points remain.
  bool adjust(const geometry::TwoViewMotion& motion, Frame& frame);

  TrackingSettings settings_;
  Optimizer& optimizer_;
  const FeatureMatcher& matcher_;
  Random random_;
  bool has_reference_ = false;
  TwoViewMap start_;
  std::vector<FeatureMatch> matches_;  // source: of the reference, feature: of the frame
};

}  // namespace holdfast
