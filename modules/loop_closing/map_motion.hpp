// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"

namespace holdfast {

/// Propagates new poses of some keyframes to the rest of the map. A keyframe without a new pose keeps its pose relative
/// to its parent (or to the keyframe before it, if it has no parent), a point relative to its reference keyframe. With
/// one camera, the scale around a keyframe changes as well (similarity).
class MapMotion {
 public:
  /// `poses[i]` is the new T_camera_world of `keyframes[i]`; removed keyframes are skipped. `scales` (may be empty) are
  /// scale factors of the lengths around the keyframes. `is_weak` (may be empty) marks keyframes with few shared
  /// points: if the optimised pose differs by more than divergence_from_parent from that relative to the parent, it is
  /// rejected as diverged and the keyframe follows its parent.
  MapMotion(const Map& map, std::span<const KeyFrameId> keyframes, std::span<const Eigen::Isometry3d> poses,
            std::span<const double> scales = {}, std::span<const std::uint8_t> is_weak = {});

  /// Sets the poses of all keyframes, and turns their velocities; returns the number of those that followed their
  /// parents.
  int move_keyframes(Map& map) const;
  /// Moves a point and its viewing direction with its reference keyframe.
  void move_point(MapPoint& point) const;

 private:
  struct Pose {
    KeyFrameId keyframe;
    Eigen::Isometry3d T_camera_world;
    bool carried = false;
    double scale = 1.0;
  };
  std::vector<Pose> poses_;  // of all keyframes
  // By slot, transformation of the points around a keyframe from old to new: scale, then rigid motion.
  std::vector<Eigen::Isometry3d> motion_;
  std::vector<double> scale_;
};

}  // namespace holdfast
