// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/check.hpp"

namespace holdfast {

/// A rectangle of pixels, borders included.
struct PixelBounds {
  float min_x = 0, min_y = 0, max_x = 0, max_y = 0;

  bool contains(float x, float y) const { return x >= min_x && x <= max_x && y >= min_y && y <= max_y; }
};

/// A spatial index of features: a counting sort into square cells, so that a window query visits only nearby features.
/// Positions are in pixels; which pixels (raw or undistorted) is up to the caller.
class FeatureGrid {
 public:
  /// Sorts features into cells of `cell_size` pixels. Features outside the bounds are assigned to the border cells.
  void build(std::span<const float> x, std::span<const float> y, const PixelBounds& bounds, float cell_size = 20.0F);

  /// Appends to `found` the features with |x - centre_x| < radius and |y - centre_y| < radius, ordered by cell (row by
  /// row), then by index.
  void query(float centre_x, float centre_y, float radius, std::span<const float> x, std::span<const float> y,
             std::vector<std::uint32_t>& found) const;

  bool empty() const { return features_.empty(); }
  /// Whether a position lies within the bounds that were given to build().
  bool covers(float x, float y) const { return bounds_.contains(x, y); }

 private:
  int column_of(float x) const;
  int row_of(float y) const;

  PixelBounds bounds_;
  float inverse_cell_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cell_begin_;  // per cell, plus one
  std::vector<std::uint32_t> features_;    // by cell
};

// Truncation differs from rounding down below 0 only, where both are clamped to the border cells.
inline int FeatureGrid::column_of(float x) const {
  return std::clamp(static_cast<int>((x - bounds_.min_x) * inverse_cell_), 0, columns_ - 1);
}

inline int FeatureGrid::row_of(float y) const {
  return std::clamp(static_cast<int>((y - bounds_.min_y) * inverse_cell_), 0, rows_ - 1);
}

inline void FeatureGrid::build(std::span<const float> x, std::span<const float> y, const PixelBounds& bounds,
                               float cell_size) {
  HOLDFAST_CHECK(x.size() == y.size() && cell_size > 0, x.size() << " " << y.size() << " " << cell_size);
  bounds_ = bounds;
  inverse_cell_ = 1.0F / cell_size;
  columns_ = std::max(1, static_cast<int>(std::ceil((bounds.max_x - bounds.min_x) * inverse_cell_)));
  rows_ = std::max(1, static_cast<int>(std::ceil((bounds.max_y - bounds.min_y) * inverse_cell_)));
  cell_begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  features_.resize(x.size());

  const auto cell_of = [&](std::size_t i) {
    return static_cast<std::size_t>(row_of(y[i])) * columns_ + column_of(x[i]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) ++cell_begin_[cell_of(i) + 1];
  for (std::size_t cell = 1; cell < cell_begin_.size(); ++cell) cell_begin_[cell] += cell_begin_[cell - 1];
  // Filling advances each cell's begin to its end, which is the begin of the next cell; shift back afterwards.
  for (std::size_t i = 0; i < x.size(); ++i) features_[cell_begin_[cell_of(i)]++] = static_cast<std::uint32_t>(i);
  std::rotate(cell_begin_.begin(), cell_begin_.end() - 1, cell_begin_.end());
  cell_begin_.front() = 0;
}

inline void FeatureGrid::query(float centre_x, float centre_y, float radius, std::span<const float> x,
                               std::span<const float> y, std::vector<std::uint32_t>& found) const {
  if (features_.empty()) return;
  const int first_column = column_of(centre_x - radius), last_column = column_of(centre_x + radius);
  const int first_row = row_of(centre_y - radius), last_row = row_of(centre_y + radius);
  std::size_t count = found.size();
  for (int row = first_row; row <= last_row; ++row) {
    // The cells of a row are contiguous in memory: one run per row.
    const std::size_t row_begin = static_cast<std::size_t>(row) * columns_;
    const std::uint32_t begin = cell_begin_[row_begin + first_column];
    const std::uint32_t end = cell_begin_[row_begin + last_column + 1];
    found.resize(count + (end - begin));
    // Without a branch, because no processor can predict which features are near.
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t feature = features_[i];
      const bool is_near_x = std::abs(x[feature] - centre_x) < radius,
                 is_near_y = std::abs(y[feature] - centre_y) < radius;
      found[count] = feature;
      count += static_cast<std::size_t>(is_near_x & is_near_y);
    }
  }
  found.resize(count);
}

}  // namespace holdfast
