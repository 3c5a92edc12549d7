// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace holdfast {

/// Statistics of the frames around tracking losses.
struct LossRecord {
  std::size_t tracked_backwards = 0;  ///< frames whose pose was estimated later, by backward tracking
  std::size_t located_late = 0;       ///< frames whose pose was estimated at the end of the run, in the finished map
  std::size_t placed_by_inertia = 0;  ///< frames whose pose was estimated at the end from those before and after them
  std::size_t withdrawn = 0;          ///< frames whose pose after a loss was not confirmed and was removed
  std::size_t submaps = 0;            ///< submaps begun after losses
  std::size_t left_out = 0;           ///< frames with a pose in a submap that was never joined with the main one
};

}  // namespace holdfast
