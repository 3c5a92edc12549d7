// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// A verified loop.
struct LoopMeasurement {
  KeyFrameId keyframe;
  KeyFrameId candidate;
  Eigen::Isometry3d T_camera_world;                          ///< of the keyframe, relative to the candidate's points
  std::vector<std::pair<MapPointId, std::uint32_t>> points;  ///< of the candidate, and features of the keyframe
  bool scale_is_free = false;                                ///< monocular: the scale is estimated as well
  double scale = 1.0;                                        ///< of the Sim(3) from keyframe to candidate
};

/// Closes a loop in the map (Mur-Artal et al. 2015, sections VII-C and VII-D). Acquires the map's lock for short
/// intervals. One object, one loop.
class LoopCorrection {
 public:
  LoopCorrection(const LoopClosingSettings& settings, Map& map, MapMutex& map_mutex, Optimizer& optimizer,
                 const FeatureMatcher& matcher, const LoopMeasurement& loop)
      : settings_(settings), map_(map), map_mutex_(map_mutex), optimizer_(optimizer), matcher_(matcher), loop_(loop) {}

  /// `structure` holds SharedMap::structure_mutex. False if the pose graph could not be solved; then the map is
  /// unchanged.
  bool run(const std::lock_guard<std::mutex>& structure);
  int points_fused() const { return points_fused_; }

 private:
  void build_graph();
  void add_loop_edges();
  /// Fixes the gauge: the first keyframe of every submap, except the younger one of two joined submaps.
  void fix_submaps();
  /// If the loop joins two submaps, transforms the younger one rigidly as initial value of the solver.
  void bring_pieces_together();
  /// With inertial measurements, four degrees of freedom for the solver: keyframes get the roll and pitch that these
  /// say, in the world of the older submap.
  void make_upright();
  bool has_verticals(std::uint32_t submap) const;
  void turn_upright(std::uint32_t submap);
  void move_map();
  void fuse_matches();
  void fuse_into(KeyFrameId target);
  void fuse(MapPointId place_point, KeyFrameId keyframe, std::uint32_t feature);

  const LoopClosingSettings& settings_;
  Map& map_;
  MapMutex& map_mutex_;
  Optimizer& optimizer_;
  const FeatureMatcher& matcher_;
  const LoopMeasurement& loop_;
  std::vector<KeyFrameId> current_side_, place_side_;  // the keyframe and the candidate first
  std::vector<KeyFrameId> nodes_;
  std::vector<std::uint32_t> node_of_slot_;
  std::uint32_t keyframe_submap_ = 0, place_submap_ = 0;
  PoseGraphProblem graph_;
  int points_fused_ = 0;
};

}  // namespace holdfast
