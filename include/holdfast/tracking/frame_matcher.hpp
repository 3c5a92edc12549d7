// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/tracking/local_map.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Match of a feature with a point of visual odometry: a feature with depth of the previous frame that has no map
/// point.
struct OdometryMatch {
  std::uint32_t feature = 0;
  Eigen::Vector3d position;  ///< world [m]
};

/// Matches the features of a frame with map points of the previous frame (guided by a predicted pose), of a keyframe
/// (by descriptors alone), or of the local map. Results are written to frame.map_points. Keeps its buffers; one thread,
/// within a MapAccess.
class FrameMatcher {
 public:
  /// The map and the matcher of features must outlive the object.
  FrameMatcher(const TrackingSettings& settings, Map& map, const FeatureMatcher& matcher = nearest_matcher())
      : settings_(settings), map_(map), matcher_(matcher), local_map_(settings.local_keyframes) {}

  /// Projects the map points of the previous frame by frame.T_camera_world and replaces the frame's matches by features
  /// within `radius` pixels times the scale of the octave. Ids of removed points are cleared in `previous`. Returns the
  /// number of matches.
  int match_previous(Frame& previous, float radius, Frame& frame);
  /// Like match_previous(), and also matches static features of the previous frame that have depth but no map point
  /// (visual odometry). `odometry` is replaced by these matches. Returns the number of matches of both kinds.
  int match_previous_features(Frame& previous, float radius, Frame& frame, std::vector<OdometryMatch>& odometry);
  /// Replaces the frame's matches by mutual nearest neighbours among the descriptors of a keyframe's map points.
  /// Returns the number of matches.
  int match_keyframe(const Frame& keyframe_frame, Frame& frame);
  /// Updates the local map for the frame and matches its points by guided search. `window` multiplies the search
  /// radius, see LocalMap::project.
  void match_local_map(float window, Frame& frame);

  LocalMap& local_map() { return local_map_; }

 private:
  int search_previous(Frame& previous, float radius, Frame& frame, std::vector<OdometryMatch>* odometry);

  const TrackingSettings settings_;
  Map& map_;
  const FeatureMatcher& matcher_;
  LocalMap local_map_;
  std::vector<FeatureMatch> matches_;
  matching::SearchWindows windows_;
  std::vector<std::uint8_t> usable_;  // features that may be matched, by index
};

}  // namespace holdfast
