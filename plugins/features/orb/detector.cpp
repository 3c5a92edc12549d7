// SPDX-License-Identifier: BSD-3-Clause
#include "detector.hpp"

#include <algorithm>
#include <cstring>

namespace holdfast::orb_plugin {

void CornerDetector::begin(const ImageView& image) {
  width_ = image.width - 2 * border;
  height_ = image.height - 2 * border;
  score_stride_ = width_ + 2;
  const std::size_t size = static_cast<std::size_t>(score_stride_) * (height_ + 2);
  if (scores_.size() < size) scores_.resize(size);
  if (columns_.size() < static_cast<std::size_t>(width_)) columns_.resize(width_);
  std::memset(scores_.data(), 0, score_stride_);
  std::memset(scores_.data() + (height_ + 1) * score_stride_, 0, score_stride_);
  for (int y = 1; y <= height_; ++y) {
    std::uint8_t* row = scores_.data() + y * score_stride_;
    row[0] = row[width_ + 1] = 0;
  }
}

void CornerDetector::score(const ImageView& image, const Region& region, int threshold) {
  kernels_.fast_scores({image.at(border + region.x, border + region.y), image.stride, region.width, region.height},
                       threshold, {scores_.data() + (region.y + 1) * score_stride_ + region.x + 1, score_stride_});
}

void CornerDetector::find_empty_cells(const std::vector<Corner>& corners) {
  const int columns = std::max(1, width_ / cell_size_), rows = std::max(1, height_ / cell_size_);
  // Position x belongs to cell x * columns / width, whose first position is the rounded-up border.
  const auto first_x = [&](int column) { return (column * width_ + columns - 1) / columns; };
  const auto first_y = [&](int row) { return (row * height_ + rows - 1) / rows; };
  cell_column_.resize(width_);
  cell_row_.resize(height_);
  for (int column = 0; column < columns; ++column)
    std::fill(cell_column_.begin() + first_x(column), cell_column_.begin() + first_x(column + 1),
              static_cast<std::uint16_t>(column));
  for (int row = 0; row < rows; ++row)
    std::fill(cell_row_.begin() + first_y(row), cell_row_.begin() + first_y(row + 1), static_cast<std::uint16_t>(row));
  is_occupied_.assign(static_cast<std::size_t>(columns) * rows, 0);
  for (const Corner& corner : corners)
    is_occupied_[cell_row_[corner.y - border] * columns + cell_column_[corner.x - border]] = 1;

  // Runs of empty cells of a row are searched in one go.
  empty_.clear();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns;) {
      int end = column;
      while (end < columns && is_occupied_[row * columns + end] == 0) ++end;
      if (end > column)
        empty_.push_back(
            {first_x(column), first_y(row), first_x(end) - first_x(column), first_y(row + 1) - first_y(row)});
      column = end + 1;
    }
  }
}

}  // namespace holdfast::orb_plugin
