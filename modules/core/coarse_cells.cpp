// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/coarse_cells.hpp"

#include <algorithm>
#include <cstddef>

#include "holdfast/core/check.hpp"

namespace holdfast {

void find_cells(const CoarseGrid& grid, std::span<const float> x, std::span<const float> y,
                std::span<std::int32_t> cells, int margin) {
  HOLDFAST_CHECK(x.size() == cells.size() && y.size() == cells.size(), x.size()
                                                                           << " " << y.size() << " " << cells.size());
  constexpr float per_pixel = 1.0F / static_cast<float>(CoarseGrid::step);
  const float left = grid.left, top = grid.top, least = static_cast<float>(CoarseGrid::step * margin);
  const float width = static_cast<float>(CoarseGrid::step * (grid.columns - margin));
  const float height = static_cast<float>(CoarseGrid::step * (grid.rows - margin));
  const std::int32_t columns = grid.columns;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const float right = x[i] - left, down = y[i] - top;
    const bool is_inside = (right >= least) & (right < width) & (down >= least) & (down < height);
    // Only numbers in range are converted, and without a branch, so that the compiler converts several at once.
    const auto column = static_cast<std::int32_t>(std::min(std::max(0.0F, right), width) * per_pixel);
    const auto row = static_cast<std::int32_t>(std::min(std::max(0.0F, down), height) * per_pixel);
    cells[i] = (row * columns + column) | (static_cast<std::int32_t>(is_inside) - 1);
  }
}

}  // namespace holdfast
