// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// A place seen again, checked.
struct LoopMeasurement {
  KeyFrameId keyframe;
  KeyFrameId candidate;
  Eigen::Isometry3d T_camera_world;                          ///< of the keyframe, where the candidate's points are
  std::vector<std::pair<MapPointId, std::uint32_t>> points;  ///< of the place, and features of the keyframe
  bool with_scale = false;                                   ///< of one camera, whose scale drifts
  double scale = 1.0;                                        ///< length at the place that is 1 around the keyframe
};

/// Closes a loop in the map (Mur-Artal et al. 2015, sections VII-C and VII-D). The caller holds the surgery mutex, not
/// the map's lock. One object, one loop.
class LoopCorrection {
 public:
  LoopCorrection(const LoopClosingSettings& settings, Map& map, MapMutex& map_mutex, Optimizer& optimizer,
                 const FeatureMatcher& matcher, const LoopMeasurement& loop)
      : settings_(settings), map_(map), map_mutex_(map_mutex), optimizer_(optimizer), matcher_(matcher), loop_(loop) {}

  /// False when the pose graph could not be solved; the map is as before then.
  bool run();
  int points_fused() const { return points_fused_; }

 private:
  void build_graph();
  void add_loop_edges();
  /// Holds the first keyframe of every piece but the younger one of those that the loop joins.
  void fix_pieces();
  /// Where the loop joins two pieces, moves the younger one as a whole: the solver needs a start nearby.
  void bring_pieces_together();
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
  std::uint32_t keyframe_piece_ = 0, place_piece_ = 0;
  PoseGraphProblem graph_;
  int points_fused_ = 0;
};

}  // namespace holdfast
