// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

/// The part of the map that a frame may see: points of the keyframes that share points with it, and of their neighbours
/// (Mur-Artal et al. 2015, section V-D), copied into flat arrays so that projecting thousands of points is one pass
/// over memory. Rebuilt only when the map or the reference keyframe changes. One thread.
class LocalMap {
 public:
  explicit LocalMap(int most_keyframes) : most_keyframes_(most_keyframes) {}

  /// Brings the local map up to date for a frame whose map points name what is matched so far. `map_version` must
  /// change whenever the map did.
  void update(Map& map, const Frame& frame, std::uint64_t map_version);

  /// Adds the windows of all points that the frame should see and does not show yet, and counts the points as visible.
  /// `radius_factor` multiplies the radius, which is 2.5 px, or 4 px for points seen at an angle, times the scale of
  /// the expected octave. SearchWindows::source counts the points of points().
  void project(const Frame& frame, float radius_factor, matching::SearchWindows& windows);

  /// Counts the points that the frame's features show as found, and writes the counts into the map when it is about to
  /// be changed or the local map rebuilt.
  void count_found(const Frame& frame);
  void write_counts(Map& map);

  KeyFrameId reference_keyframe() const { return reference_keyframe_; }
  const std::vector<KeyFrameId>& keyframes() const { return keyframes_; }
  const PointBlock& points() const { return points_; }

 private:
  bool vote(const Map& map, const Frame& frame);
  void collect_keyframes(const Map& map);
  void collect_points(const Map& map);
  void mark_shown(const Frame& frame);

  int most_keyframes_;
  std::uint64_t map_version_ = ~std::uint64_t{0};
  KeyFrameId reference_keyframe_;
  std::vector<KeyFrameId> keyframes_;
  std::vector<int> votes_;  // by keyframe slot
  std::vector<KeyFrameId> voted_;

  PointBlock points_;
  std::vector<std::uint32_t> visible_, found_;  // entry i of each belongs to point i
  std::vector<std::uint8_t> shown_;
  std::vector<std::int32_t> index_of_slot_;  // of a map point's slot, -1 = not local
};

}  // namespace holdfast
