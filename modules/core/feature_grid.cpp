// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/feature_grid.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/error.hpp"

namespace holdfast {

int FeatureGrid::column_of(float x) const {
  return std::clamp(static_cast<int>(std::floor((x - minimum_x_) * inverse_cell_)), 0, columns_ - 1);
}

int FeatureGrid::row_of(float y) const {
  return std::clamp(static_cast<int>(std::floor((y - minimum_y_) * inverse_cell_)), 0, rows_ - 1);
}

void FeatureGrid::build(std::span<const float> x, std::span<const float> y, float minimum_x, float minimum_y,
                        float maximum_x, float maximum_y, float cell_size) {
  HOLDFAST_CHECK(x.size() == y.size() && cell_size > 0, x.size() << " " << y.size() << " " << cell_size);
  minimum_x_ = minimum_x;
  minimum_y_ = minimum_y;
  maximum_x_ = maximum_x;
  maximum_y_ = maximum_y;
  inverse_cell_ = 1.0F / cell_size;
  columns_ = std::max(1, static_cast<int>(std::ceil((maximum_x - minimum_x) * inverse_cell_)));
  rows_ = std::max(1, static_cast<int>(std::ceil((maximum_y - minimum_y) * inverse_cell_)));
  cell_begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  features_.resize(x.size());

  const auto cell_of = [&](std::size_t i) {
    return static_cast<std::size_t>(row_of(y[i])) * columns_ + column_of(x[i]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) ++cell_begin_[cell_of(i) + 1];
  for (std::size_t cell = 1; cell < cell_begin_.size(); ++cell) cell_begin_[cell] += cell_begin_[cell - 1];
  // Filling moves each cell's begin to its end, which is the next cell's begin: shift back afterwards.
  for (std::size_t i = 0; i < x.size(); ++i) features_[cell_begin_[cell_of(i)]++] = static_cast<std::uint32_t>(i);
  std::rotate(cell_begin_.begin(), cell_begin_.end() - 1, cell_begin_.end());
  cell_begin_.front() = 0;
}

void FeatureGrid::query(float centre_x, float centre_y, float radius, std::span<const float> x,
                        std::span<const float> y, std::vector<std::uint32_t>& found) const {
  if (features_.empty()) return;
  const int first_column = column_of(centre_x - radius), last_column = column_of(centre_x + radius);
  const int first_row = row_of(centre_y - radius), last_row = row_of(centre_y + radius);
  for (int row = first_row; row <= last_row; ++row) {
    // Cells of a row are neighbours in memory: one run per row.
    const std::size_t row_begin = static_cast<std::size_t>(row) * columns_;
    const std::uint32_t begin = cell_begin_[row_begin + first_column];
    const std::uint32_t end = cell_begin_[row_begin + last_column + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t feature = features_[i];
      if (std::abs(x[feature] - centre_x) < radius && std::abs(y[feature] - centre_y) < radius)
        found.push_back(feature);
    }
  }
}

}  // namespace holdfast
