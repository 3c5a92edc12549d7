// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
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
#include "holdfast/mapping/pair_calibrator.hpp"

namespace holdfast {

/// Local mapping around each new keyframe (Mur-Artal et al. 2015, section VI; with depth, Mur-Artal and Tardos 2017,
/// section III): creation of points from depth and by triangulation, culling of weak new points, fusion of duplicate
/// points, local bundle adjustment, culling of redundant keyframes.
///
/// Two threads may share a mapper: one inserts keyframes, the other refines the map around them. No other thread may
/// move or remove keyframes or points while refine() runs; reading under the lock is allowed.
class LocalMapper {
 public:
  /// A feature with depth up to `close_depth_factor` baselines creates a map point at once; farther points are
  /// triangulated (TrackingSettings::close_depth_factor). Map, mutex, optimizer and matcher must outlive the mapper.
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
  /// the submap `submap`. Fast. Adds the stage "mapping: insertion".
  KeyFrameId insert(const MapAccess& map, const Frame& frame, bool points_wait, StageTimes& times,
                    std::uint32_t submap = 0);

  /// Initialises a map from two views without depth: inserts the first keyframe with the triangulated points. `points`
  /// lists each position [world] and its feature in the keyframe; the ids of the points are written to `ids`, in the
  /// same order, and insert() of the second keyframe, whose frame refers to them, must follow. Adds the stage
  /// "mapping: insertion".
  KeyFrameId begin(const MapAccess& map, const Frame& frame,
                   std::span<const std::pair<Eigen::Vector3d, std::uint32_t>> points, std::vector<MapPointId>& ids,
                   StageTimes& times);

  /// Announces that keyframes are refined only after their masks have arrived. Later keyframes may then have created
  /// points by an older mask, so that such points need a second observation. Must be called before the first insert().
  void expect_masks() { expects_masks_ = true; }

  /// Corrects and estimates the errors of a stereo pair's calibration (PairCalibrator). Call it before the first
  /// insert().
  void calibrate_pair(StereoCalibration& calibration) {
    calibrator_ = std::make_unique<PairCalibrator>(map_, mutex_, calibration);
  }

  /// Refines the map around an inserted keyframe and returns the removed keyframes. Acquires the lock of the map for
  /// short intervals and not during the bundle adjustment. Has no effect for a removed keyframe. Adds stages "mapping:
  /// ...".
  std::vector<KeyFrameId> refine(KeyFrameId keyframe, StageTimes& times);

  /// Searches the points of every keyframe in its neighbours and theirs in it, as refine() does for one, the oldest
  /// keyframe first: after an adjustment of the whole map, observations come within reach that local adjustments
  /// removed. Acquires the lock of the map for short intervals; the caller holds the structure mutex (SharedMap).
  /// `stop` ends it after a keyframe. Adds the stage "mapping: fusion".
  void fuse_whole_map(const std::atomic<bool>& stop, StageTimes& times);

  /// Resets the mapper after the map was cleared, except counts(). No other thread may refine.
  void forget_map() {
    recent_points_.clear();
    if (calibrator_) calibrator_->forget_map();
  }

  /// Requests a running bundle adjustment to end after its current iteration; may be called by any thread.
  void request_stop() { stop_ = true; }

  /// Cumulative statistics. Must not be called while another thread inserts or refines.
  const MappingCounts& counts() const { return counts_; }

 private:
  void make_points_from_depth(KeyFrameId keyframe);

  MappingSettings settings_;
  double close_depth_factor_;
  Map& map_;
  MapMutex& mutex_;
  Optimizer& optimizer_;
  const FeatureMatcher& matcher_;
  std::atomic<bool> stop_{false};
  bool expects_masks_ = false;
  std::unique_ptr<PairCalibrator> calibrator_;  // of a stereo pair whose calibration is corrected
  bool disparities_changed_ = false;            // since the last bundle adjustment
  std::vector<MapPointId> recent_points_;
  MappingCounts counts_;
};

}  // namespace holdfast
