// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace holdfast {

/// Numbers of segmented frames so far.
struct MaskCounts {
  std::size_t segmented = 0;       ///< segmented frames whose result has arrived
  std::size_t found = 0;           ///< those with a segmentation
  std::size_t mostly_movable = 0;  ///< those in which movable classes cover more than half of the labelled area
  /// Those of mostly_movable in which they also cover more than 9/10 of the upper edge. People seldom do, however near;
  /// the background nearly always does, so that such masks are probably inverted.
  std::size_t upper_edge_movable = 0;
};

}  // namespace holdfast
