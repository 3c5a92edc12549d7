// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "holdfast/core/coarse_view.hpp"

namespace holdfast {

/// CoarseGrid::cell_of() for each of several undistorted pixels, vectorised: the cell that holds the pixel, or -1
/// outside the grid and in the outer `margin` columns and rows. The spans have the same size.
void find_cells(const CoarseGrid& grid, std::span<const float> x, std::span<const float> y,
                std::span<std::int32_t> cells, int margin = 0);

}  // namespace holdfast
