// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

/// A neighbour in the covisibility graph and the number of map points seen by both.
struct CovisibilityEdge {
  KeyFrameId keyframe;
  int weight = 0;
};

/// A frame that the map remembers. Changed through Map.
struct KeyFrame {
  std::uint64_t sequence = 0;  ///< 0 for the first keyframe of the map, then counting up; never reused
  Frame frame;                 ///< frame.T_camera_world is the keyframe's pose, frame.map_points its observations
  std::vector<CovisibilityEdge> covisible;  ///< by falling weight, equal weights by rising sequence
  KeyFrameId parent;                        ///< in the spanning tree; invalid for the first keyframe
  std::vector<KeyFrameId> children;         ///< in the spanning tree, by time of adding
  std::vector<KeyFrameId> loop_edges;       ///< keyframes at the other end of closed loops; never culled
};

}  // namespace holdfast
