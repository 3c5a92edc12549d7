// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace holdfast {

/// What became of the frames around losses.
struct LossRecord {
  std::size_t tracked_backwards = 0;  ///< frames that had no pose and got one after later frames
  std::size_t withdrawn = 0;          ///< frames that had a pose after a loss and lost it, because nothing confirmed it
  std::size_t submaps = 0;            ///< submaps that a lost camera began
  std::size_t left_out = 0;           ///< frames that had a pose in a submap that nothing joined with the rest
};

}  // namespace holdfast
