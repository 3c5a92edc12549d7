// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

class Map;

/// A copy of the map's geometry at one time, without images and descriptors, for display or path planning. It is
/// independent of the map and never modified afterwards. Metres, world frame of the run.
struct MapSnapshot {
  /// Pose and time of a keyframe.
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
    std::uint32_t observations = 0;  ///< number of keyframes that observe it
    float static_log_odds = 0.0F;    ///< accumulated log-odds that it is static; 0 = unknown
  };
  /// An edge of the essential graph (Mur-Artal et al. 2015, section III-D), each pair listed once: the spanning tree,
  /// and keyframes that share at least 100 points.
  struct Covisibility {
    KeyFrameId older;
    KeyFrameId newer;
  };
  /// A loop edge between two keyframes; each pair is listed once.
  struct Loop {
    KeyFrameId older;
    KeyFrameId newer;
  };

  std::vector<KeyFrame> keyframes;         ///< oldest first
  std::vector<Point> points;               ///< by id
  std::vector<Covisibility> covisibility;  ///< by the newer keyframe, oldest first
  std::vector<Loop> loops;
};

/// Copies the map. The caller must ensure that no other thread modifies the map meanwhile; for a running pipeline, use
/// Pipeline::map_snapshot().
MapSnapshot make_snapshot(const Map& map);

}  // namespace holdfast
