// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

/// An edge of the covisibility graph: the neighbour and the number of shared map points.
struct CovisibilityEdge {
  KeyFrameId keyframe;
  int weight = 0;
};

/// A frame stored in the map. It is modified through Map only.
struct KeyFrame {
  std::uint64_t sequence = 0;  ///< 0 for the first keyframe of the map, then increasing; never reused
  Frame frame;                 ///< frame.T_camera_world is the keyframe's pose, frame.map_points its observations
  /// Which piece of the map it belongs to. A lost camera may begin a new piece, whose pose relative to the others is a
  /// guess until a place seen in both joins them; files keep one piece.
  std::uint32_t piece = 0;
  std::vector<CovisibilityEdge> covisible;  ///< by decreasing weight, equal weights by increasing sequence
  KeyFrameId parent;                        ///< in the spanning tree; invalid for the first keyframe of a piece
  std::vector<KeyFrameId> children;         ///< in the spanning tree, in order of insertion
  /// What lengths around this keyframe have been multiplied by since it was made: 1 but for one camera whose loops were
  /// closed. A pose that was stored relative to this keyframe follows by it; files do not keep it.
  double scale = 1.0;
  std::vector<KeyFrameId> loop_edges;  ///< other ends of closed loops; a keyframe with one is never culled
};

}  // namespace holdfast
