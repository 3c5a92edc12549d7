// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/map_inertia.hpp"

namespace holdfast {

/// An edge of the covisibility graph: the neighbour and the number of shared map points.
struct CovisibilityEdge {
  KeyFrameId keyframe;
  int weight = 0;
};

/// A frame stored in the map. It is modified through Map only.
struct KeyFrame {
  std::uint64_t sequence = 0;  ///< 0 for the first keyframe of the map, then increasing; not reused until Map::clear()
  Frame frame;                 ///< frame.T_camera_world is the keyframe's pose, frame.map_points its observations
  /// Submap (as an Atlas map of ORB-SLAM3). A new submap may begin after a loss; its pose relative to the others is a
  /// guess until a loop joins them. A map file contains only the submap with the most tracked frames.
  std::uint32_t submap = 0;
  std::vector<CovisibilityEdge> covisible;  ///< by decreasing weight, equal weights by increasing sequence
  KeyFrameId parent;                        ///< in the spanning tree; invalid for the first keyframe of a submap
  std::vector<KeyFrameId> children;         ///< in the spanning tree, in order of insertion
  /// Accumulated scale correction of this keyframe by loops and full adjustments of one camera's map (1 otherwise). It
  /// scales the translations of poses stored relative to this keyframe. It is not saved in map files.
  double scale = 1.0;
  std::vector<KeyFrameId> loop_edges;  ///< other ends of closed loops; a keyframe with one is never culled
  /// Direction of gravity in the frame of the camera, a unit vector, as tracking knew it by inertial measurements when
  /// the keyframe was made, or as the last adjustment found it that linked the keyframe by them.
  std::optional<Eigen::Vector3d> vertical;
  std::optional<KeyFrameMotion> motion;  ///< of the last adjustment that linked the keyframe by inertial measurements
};

}  // namespace holdfast
