// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace holdfast {

/// Cumulative statistics of local mapping.
struct MappingCounts {
  std::uint64_t keyframes_made = 0;
  std::uint64_t keyframes_removed = 0;
  std::uint64_t points_from_depth = 0;
  std::uint64_t points_triangulated = 0;
  std::uint64_t points_removed = 0;
  std::uint64_t points_moving = 0;  ///< removed because they were found to move
  std::uint64_t points_fused = 0;
  std::uint64_t observations_removed = 0;  ///< outliers of bundle adjustments
};

}  // namespace holdfast
