// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/id.hpp"

namespace holdfast {

class Map;

/// What a map holds at one moment, without images and descriptors: for drawing it, or finding a way through it. A value
/// of its own that nothing changes any more. Metres, in the world frame of the run.
struct MapSnapshot {
  /// Where a keyframe was taken.
  struct KeyFrame {
    KeyFrameId id;
    std::uint64_t sequence = 0;
    double timestamp = 0.0;  ///< [s]
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  };
  /// A map point.
  struct Point {
    MapPointId id;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::uint32_t observations = 0;  ///< keyframes that see it
    float static_log_odds = 0.0F;    ///< evidence that it stands still; 0 = unknown
  };
  /// A closed loop joins two keyframes; each pair once.
  struct Loop {
    KeyFrameId older;
    KeyFrameId newer;
  };

  std::vector<KeyFrame> keyframes;  ///< oldest first
  std::vector<Point> points;        ///< by id
  std::vector<Loop> loops;
};

/// The caller sees to it that nobody changes the map meanwhile; a running pipeline does: Pipeline::map_snapshot().
MapSnapshot make_snapshot(const Map& map);

}  // namespace holdfast
