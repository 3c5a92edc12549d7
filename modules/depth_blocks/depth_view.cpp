// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/depth_blocks/depth_view.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::depth_blocks {

BlockGrid::BlockGrid(const Camera& camera, const CoarseGrid& coarse)
    : columns(coarse.columns / stride),
      rows(coarse.rows / stride),
      fx(static_cast<float>(camera.fx)),
      fy(static_cast<float>(camera.fy)),
      cx(static_cast<float>(camera.cx)),
      cy(static_cast<float>(camera.cy)),
      first_x(coarse.x_of(0)),
      first_y(coarse.y_of(0)),
      inverse_step(1.0F / static_cast<float>(stride * CoarseGrid::step)) {
  for (int column = 0; column < columns; ++column) ray_x.push_back((coarse.x_of(column * stride) - cx) / fx);
  for (int row = 0; row < rows; ++row) ray_y.push_back((coarse.y_of(row * stride) - cy) / fy);
}

ViewMaker::ViewMaker(const Camera& camera) : sampler_(camera), grid_(camera, sampler_.grid()) {}

void ViewMaker::make(const Frame& frame, const cv::Mat& colour, DepthView& view) const {
  const std::size_t size = static_cast<std::size_t>(grid_.size());
  view.frame_index = frame.index;
  view.timestamp = frame.timestamp;
  view.depth.resize(size);
  view.grey.resize(size);
  view.static_score.assign(size, 1.0F);
  const int coarse_columns = sampler_.grid().columns;
  // Nine of the block's pixels: enough against aliasing.
  constexpr int spacing = 3;
  const bool too_small = std::min(colour.cols, colour.rows) <= 2 * spacing;
  for (int row = 0; row < grid_.rows; ++row)
    for (int column = 0; column < grid_.columns; ++column) {
      const int cell = (row * coarse_columns + column) * BlockGrid::stride;
      const std::size_t block = static_cast<std::size_t>(row * grid_.columns + column);
      view.depth[block] = frame.coarse.depth[static_cast<std::size_t>(cell)];
      view.grey[block] = 0.0F;
      const std::int32_t raw = sampler_.raw_pixel(cell);
      if (raw < 0 || too_small) {
        view.depth[block] = 0.0F;
        continue;
      }
      const int x = std::clamp(raw % colour.cols, spacing, colour.cols - 1 - spacing);
      const int y = std::clamp(raw / colour.cols, spacing, colour.rows - 1 - spacing);
      int sum = 0;
      for (int dy = -spacing; dy <= spacing; dy += spacing) {
        const std::uint8_t* line = colour.ptr<std::uint8_t>(y + dy) + 3 * x;
        for (int dx = -3 * spacing; dx <= 3 * spacing; dx += 3 * spacing)
          sum += line[dx] + 2 * line[dx + 1] + line[dx + 2];
      }
      view.grey[block] = static_cast<float>(sum) * (1.0F / 36.0F);
    }
}

Surface surface_at(const BlockGrid& grid, const DepthView& view, float column, float row) {
  Surface surface;
  if (!(column >= 0.0F) || !(row >= 0.0F)) return surface;
  const int c = static_cast<int>(column), r = static_cast<int>(row);
  if (c + 1 >= grid.columns || r + 1 >= grid.rows) return surface;
  const std::size_t first = static_cast<std::size_t>(r * grid.columns + c);
  const std::size_t second = first + static_cast<std::size_t>(grid.columns);
  const float a = view.depth[first], b = view.depth[first + 1], d = view.depth[second], e = view.depth[second + 1];
  const float nearest = std::min(std::min(a, b), std::min(d, e));
  if (nearest <= 0.0F) return surface;
  surface.known = true;
  surface.nearest = nearest;
  surface.farthest = std::max(std::max(a, b), std::max(d, e));
  const float s = column - static_cast<float>(c), t = row - static_cast<float>(r);
  constexpr float bend = 0.015F, steep = 0.12F;  // of the depth
  surface.smooth = std::abs(a - b - d + e) < bend * nearest && surface.farthest - nearest < steep * nearest;
  surface.depth_x = (1.0F - t) * (b - a) + t * (e - d);
  surface.depth_y = (1.0F - s) * (d - a) + s * (e - b);
  surface.depth = a + s * (b - a) + t * (d - a) + s * t * (a - b - d + e);
  const float ga = view.grey[first], gb = view.grey[first + 1], gd = view.grey[second], ge = view.grey[second + 1];
  surface.grey_x = (1.0F - t) * (gb - ga) + t * (ge - gd);
  surface.grey_y = (1.0F - s) * (gd - ga) + s * (ge - gb);
  surface.grey = ga + s * (gb - ga) + t * (gd - ga) + s * t * (ga - gb - gd + ge);
  return surface;
}

int block_of(const BlockGrid& grid, const DepthView& view, const Frame& frame, std::size_t feature) {
  const float x = grid.column_of(frame.x[feature]) + 0.5F, y = grid.row_of(frame.y[feature]) + 0.5F;
  if (!(x >= 0.0F) || !(y >= 0.0F)) return -1;
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  if (column >= grid.columns || row >= grid.rows) return -1;
  int best = -1;
  float least = 0.15F * std::max(frame.depth[feature], 0.1F);
  for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r)
    for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
      const int block = r * grid.columns + c;
      const float depth = view.depth[static_cast<std::size_t>(block)];
      if (depth <= 0.0F) continue;
      const bool centre = r == row && c == column;
      if (!frame.has_depth(feature)) {
        if (centre) best = block;
        continue;
      }
      const float difference = std::abs(depth - frame.depth[feature]) - (centre ? 0.02F * depth : 0.0F);
      if (difference < least) least = difference, best = block;
    }
  return best;
}

}  // namespace holdfast::depth_blocks
