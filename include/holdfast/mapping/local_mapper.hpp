// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
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
  std::uint64_t points_moving = 0;  ///< removed because they were found to move
  std::uint64_t points_fused = 0;
  std::uint64_t observations_removed = 0;  ///< outliers of bundle adjustments
};

/// Makes the map around each new keyframe (Mur-Artal et al. 2015, section VI; with depth, Mur-Artal and Tardos 2017,
/// section III): points from depth and by triangulation, removal of weak new points, fusion of points seen twice, local
/// bundle adjustment, removal of redundant keyframes.
///
/// Two threads may share a mapper: one inserts keyframes, the other refines the map around them. Nobody else may move
/// or remove anything in the map while refine() runs; reading under the lock is fine.
class LocalMapper {
 public:
  /// Map, mutex and optimizer must outlive the mapper.
  LocalMapper(const MappingSettings& settings, Map& map, MapMutex& mutex, Optimizer& optimizer)
      : settings_(settings), map_(map), mutex_(mutex), optimizer_(optimizer) {}

  /// Takes a tracked frame into the map as a keyframe, with points from its depth, or without when these have to wait
  /// for refine(). Only features that are more likely static than not make points. Quick; the caller holds the lock of
  /// the map. Adds the stage "mapping: insertion".
  KeyFrameId insert(const Frame& frame, bool points_wait, StageTimes& times);

  /// Works on the map around a keyframe that was inserted, and returns the keyframes that it removed. Takes the lock of
  /// the map for short pieces of work and not while it adjusts. Does nothing for a keyframe that is gone. Adds stages
  /// "mapping: ...".
  std::vector<KeyFrameId> refine(KeyFrameId keyframe, StageTimes& times);

  /// Makes the bundle adjustment in progress, if any, end after its current iteration; from any thread.
  void request_stop() { stop_ = true; }

  /// Not while another thread inserts or refines.
  const MappingCounts& counts() const { return counts_; }

 private:
  void make_points_from_depth(KeyFrameId keyframe);
  void drop_moving_features(KeyFrameId keyframe);
  void remove_moving_points();
  void remove_weak_points(KeyFrameId keyframe);
  void triangulate_points(KeyFrameId keyframe);
  void triangulate_with(KeyFrameId keyframe, KeyFrameId neighbour);
  std::vector<KeyFrameId> fusion_targets(KeyFrameId keyframe) const;
  std::vector<MapPointId> points_seen_by(const std::vector<KeyFrameId>& keyframes) const;
  void fuse_with_neighbours(KeyFrameId keyframe);
  void fuse_into(KeyFrameId target, const std::vector<MapPointId>& points);
  void adjust_bundle(KeyFrameId keyframe);
  void state_bundle(KeyFrameId keyframe);
  void apply_bundle();
  std::vector<KeyFrameId> remove_redundant_keyframes(KeyFrameId keyframe);

  MappingSettings settings_;
  Map& map_;
  MapMutex& mutex_;
  Optimizer& optimizer_;
  std::atomic<bool> stop_{false};
  std::vector<MapPointId> recent_points_;
  MappingCounts counts_;

  // What the bundle problem's poses, points and observations are in the map.
  BundleProblem problem_;
  std::vector<KeyFrameId> problem_keyframes_;
  std::vector<MapPointId> problem_points_;
  std::vector<std::pair<MapPointId, KeyFrameId>> problem_observations_;
};

}  // namespace holdfast
