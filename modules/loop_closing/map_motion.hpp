// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"

namespace holdfast {

/// New poses for some keyframes of a map, and what they mean for the rest: a keyframe without one of its own moves with
/// its parent (or with the keyframe before it, should it have none), as rigidly as if bolted to it, and a point moves
/// with its reference keyframe. With one camera, the world around a keyframe changes its scale as well. The caller
/// holds the map's lock.
class MapMotion {
 public:
  /// `poses[i]` is the new T_camera_world of `keyframes[i]`; those that left the map are passed over.
  /// `scales[i]`, where there are any, is what lengths around that keyframe are multiplied by. `is_weak[i]`, where there
  /// are any, says that few points hold the keyframe: if its new pose is more than 0.2 m or 0.2 rad from where it would
  /// go with its parent, it fled, and goes with its parent.
  MapMotion(const Map& map, std::span<const KeyFrameId> keyframes, std::span<const Eigen::Isometry3d> poses,
            std::span<const double> scales = {}, std::span<const std::uint8_t> is_weak = {});

  /// Sets the poses of all keyframes; returns how many were carried along.
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
  // By slot, the motion of the world around a keyframe, new from old: a point is scaled, turned and moved.
  std::vector<Eigen::Isometry3d> motion_;
  std::vector<double> scale_;
};

}  // namespace holdfast
