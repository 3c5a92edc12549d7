// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/mapping/mapping_counts.hpp"
#include "holdfast/mapping/mapping_settings.hpp"

namespace holdfast {

/// Local mapping around each new keyframe (Mur-Artal et al. 2015, section VI; with depth, Mur-Artal and Tardos 2017,
/// section III): creation of points from depth and by triangulation, culling of weak new points, fusion of duplicate
/// points, local bundle adjustment, culling of redundant keyframes.
///
/// Two threads may share a mapper: one inserts keyframes, the other refines the map around them. No other thread may
/// move or remove keyframes or points while refine() runs; reading under the lock is allowed.
class LocalMapper {
 public:
  /// Depth up to `close_depth_factor` baselines makes a map point at once; farther points are triangulated
  /// (TrackingSettings::close_depth_factor). Map, mutex, optimizer and matcher must outlive the mapper.
  LocalMapper(const MappingSettings& settings, double close_depth_factor, Map& map, MapMutex& mutex,
              Optimizer& optimizer, const FeatureMatcher& matcher = nearest_matcher())
      : settings_(settings),
        close_depth_factor_(close_depth_factor),
        map_(map),
        mutex_(mutex),
        optimizer_(optimizer),
        matcher_(matcher) {
    map_.set_covisibility_minimum(settings.covisibility_minimum);
  }

  /// Inserts a tracked frame into the map as a keyframe and creates points from its depth; with `points_wait`, refine()
  /// creates them later. Only features that are more likely static than moving create points. The keyframe belongs to
  /// `piece` of the map. Takes little time; the caller holds the lock of the map. Adds the stage "mapping: insertion".
  KeyFrameId insert(const Frame& frame, bool points_wait, StageTimes& times, std::uint32_t piece = 0);

  /// Begins a map without depth: inserts the first keyframe with points that the next one shows as well. `points` lists
  /// each position [world] and the feature of the keyframe that shows it; the ids of the points are written to `ids`,
  /// in the same order, and insert() of the next keyframe, whose frame names them, must follow. The caller holds the
  /// lock of the map. Adds the stage "mapping: insertion".
  KeyFrameId begin(const Frame& frame, std::span<const std::pair<Eigen::Vector3d, std::uint32_t>> points,
                   std::vector<MapPointId>& ids, StageTimes& times);

  /// Keyframes are refined when their masks have come, which is after later ones were inserted: points that these made
  /// in the meantime, by an older mask, need a second view. Call it before the first insert().
  void expect_masks() { expects_masks_ = true; }

  /// Refines the map around an inserted keyframe and returns the removed keyframes. Acquires the lock of the map for
  /// short intervals and not during the bundle adjustment. Has no effect for a removed keyframe. Adds stages "mapping:
  /// ...".
  std::vector<KeyFrameId> refine(KeyFrameId keyframe, StageTimes& times);

  /// As if no keyframe had been inserted, but for counts(). The map is empty; no other thread refines.
  void forget_map() { recent_points_.clear(); }

  /// Requests a running bundle adjustment to end after its current iteration; may be called by any thread.
  void request_stop() { stop_ = true; }

  /// Must not be called while another thread inserts or refines.
  const MappingCounts& counts() const { return counts_; }

 private:
  void make_points_from_depth(KeyFrameId keyframe);
  /// Removes the observations of a keyframe that are probably on something that moves, and returns their points.
  std::vector<MapPointId> drop_moving_features(KeyFrameId keyframe);
  /// With one camera, removes a point that has lost a view and is left with fewer than three (as in ORB-SLAM). For the
  /// thread of refine(), which counts on points to stay meanwhile.
  void drop_weak_point(MapPointId point);
  void remove_moving_points();
  void remove_weak_points(KeyFrameId keyframe);
  void triangulate_points(KeyFrameId keyframe);
  void triangulate_with(KeyFrameId keyframe, KeyFrameId neighbour);
  /// Updates the covisibility of a new keyframe, which gets a parent unless it is the first of its piece.
  void link(KeyFrameId keyframe);
  std::vector<KeyFrameId> fusion_targets(KeyFrameId keyframe) const;
  void fuse_with_neighbours(KeyFrameId keyframe);
  struct FusionBuffers;
  void fuse_into(KeyFrameId target, const std::vector<MapPointId>& points, FusionBuffers& buffers);
  void adjust_bundle(KeyFrameId keyframe);
  void build_bundle_problem(KeyFrameId keyframe);
  void apply_bundle();
  std::vector<KeyFrameId> remove_redundant_keyframes(KeyFrameId keyframe);

  MappingSettings settings_;
  double close_depth_factor_;
  Map& map_;
  MapMutex& mutex_;
  Optimizer& optimizer_;
  const FeatureMatcher& matcher_;
  std::atomic<bool> stop_{false};
  bool expects_masks_ = false;
  std::vector<MapPointId> recent_points_;
  MappingCounts counts_;

  // Of each free keyframe of the bundle problem, how many of its points another keyframe sees as well.
  std::vector<int> problem_shared_points_;
  // Keyframes, points and observations of the bundle problem.
  BundleProblem problem_;
  std::vector<KeyFrameId> problem_keyframes_;
  std::vector<MapPointId> problem_points_;
  std::vector<std::pair<MapPointId, KeyFrameId>> problem_observations_;
};

}  // namespace holdfast
