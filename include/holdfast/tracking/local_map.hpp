// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/matching/point_block.hpp"

namespace holdfast {

/// Local map of a frame: points of the keyframes that share points with it, and of their neighbours (Mur-Artal et al.
/// 2015, section V-D). The points are copied into flat arrays for fast projection. Rebuilt only when the map or the
/// reference keyframe changes. One thread.
class LocalMap {
 public:
  explicit LocalMap(int most_keyframes) : most_keyframes_(most_keyframes) {}

  /// Updates the local map for a frame with its matches so far. `map_version` must change whenever the map changes
  /// (Map::version()).
  void update(Map& map, const Frame& frame, std::uint64_t map_version);

  /// Adds search windows for all points that are predicted to be visible and not matched yet, and increments their
  /// visible counts. The radius is 2.5 px (4 px for points seen at an angle to their viewing direction) times the scale
  /// of the expected octave and `radius_factor`. SearchWindows::source is an index into points().
  void project(const Frame& frame, float radius_factor, matching::SearchWindows& windows);

  /// Increments the found counts of the points matched in the frame. Counts are written to the map before it is changed
  /// or the local map is rebuilt.
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
