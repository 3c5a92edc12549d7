// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/mapping/mapping_settings.hpp"

namespace holdfast {

/// What became of the map's content so far; for the report.
struct MappingCounts {
  std::uint64_t keyframes_made = 0;
  std::uint64_t keyframes_removed = 0;
  std::uint64_t points_from_depth = 0;
  std::uint64_t points_triangulated = 0;
  std::uint64_t points_removed = 0;
  std::uint64_t points_fused = 0;
  std::uint64_t observations_removed = 0;  ///< outliers of bundle adjustments
};

/// Makes the map around each new keyframe (Mur-Artal et al. 2015, section VI; with depth, Mur-Artal and Tardos 2017,
/// section III): points from depth and by triangulation, removal of weak new points, fusion of points seen twice, local
/// bundle adjustment, removal of redundant keyframes. One thread; the map must not be used by others meanwhile.
class LocalMapper {
 public:
  /// Map and optimizer must outlive the mapper.
  LocalMapper(const MappingSettings& settings, Map& map, Optimizer& optimizer)
      : settings_(settings), map_(map), optimizer_(optimizer) {}

  /// Takes a tracked frame into the map as a keyframe and works on the map around it. Adds stages "mapping: ...".
  KeyFrameId add_keyframe(const Frame& frame, StageTimes& times);

  const MappingCounts& counts() const { return counts_; }
  /// Makes a bundle adjustment in progress end early.
  void request_stop() { stop_ = true; }

 private:
  void make_points_from_depth(KeyFrameId keyframe);
  void remove_weak_points(KeyFrameId keyframe);
  void triangulate_points(KeyFrameId keyframe);
  void triangulate_with(KeyFrameId keyframe, KeyFrameId neighbour);
  void fuse_with_neighbours(KeyFrameId keyframe);
  void fuse_into(KeyFrameId target, const std::vector<MapPointId>& points);
  void adjust_bundle(KeyFrameId keyframe);
  void remove_redundant_keyframes(KeyFrameId keyframe);

  MappingSettings settings_;
  Map& map_;
  Optimizer& optimizer_;
  std::atomic<bool> stop_{false};
  std::vector<MapPointId> recent_points_;
  MappingCounts counts_;
  BundleProblem problem_;
};

}  // namespace holdfast
