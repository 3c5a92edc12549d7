// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "holdfast/core/check.hpp"

namespace holdfast {

/// A rectangle of pixels, borders included.
struct PixelBounds {
  float min_x = 0, min_y = 0, max_x = 0, max_y = 0;

  bool contains(float x, float y) const { return x >= min_x && x <= max_x && y >= min_y && y <= max_y; }
};

/// A spatial index of features: a counting sort into square cells, so that a window query visits only nearby features.
/// Positions are in pixels; which pixels (raw or undistorted) is up to the caller. The grid keeps a copy of them in the
/// order of its cells, so that a query reads memory from front to back.
class FeatureGrid {
 public:
  /// Sorts features into cells of `cell_size` pixels. Features outside the bounds are assigned to the border cells.
  void build(std::span<const float> x, std::span<const float> y, const PixelBounds& bounds, float cell_size = 20.0F);

  /// Appends to `found` the features with |x - centre_x| < radius and |y - centre_y| < radius, ordered by cell (row by
  /// row), then by index.
  void query(float centre_x, float centre_y, float radius, std::vector<std::uint32_t>& found) const;

  bool empty() const { return features_.size() <= batch; }
  /// Whether a position lies within the bounds that were given to build().
  bool covers(float x, float y) const { return bounds_.contains(x, y); }

 private:
  static constexpr std::size_t batch = 4;  // features that a query looks at together

  int column_of(float x) const;
  int row_of(float y) const;
  /// Bit i: whether feature i of the batch that begins at `first` is near the centre.
  unsigned near_of_batch(std::size_t first, float centre_x, float centre_y, float radius) const;

  PixelBounds bounds_;
  float inverse_cell_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cell_begin_;  // per cell, plus one
  // By cell, followed by a batch that belongs to no cell.
  std::vector<std::uint32_t> features_;
  std::vector<float> x_, y_;
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
  features_.resize(x.size() + batch);
  x_.resize(x.size() + batch), y_.resize(y.size() + batch);

  const auto cell_of = [&](std::size_t i) {
    return static_cast<std::size_t>(row_of(y[i])) * columns_ + column_of(x[i]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) ++cell_begin_[cell_of(i) + 1];
  for (std::size_t cell = 1; cell < cell_begin_.size(); ++cell) cell_begin_[cell] += cell_begin_[cell - 1];
  // Filling advances each cell's begin to its end, which is the begin of the next cell; shift back afterwards.
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::uint32_t place = cell_begin_[cell_of(i)]++;
    features_[place] = static_cast<std::uint32_t>(i);
    x_[place] = x[i], y_[place] = y[i];
  }
  std::rotate(cell_begin_.begin(), cell_begin_.end() - 1, cell_begin_.end());
  cell_begin_.front() = 0;
}

inline unsigned FeatureGrid::near_of_batch(std::size_t first, float centre_x, float centre_y, float radius) const {
#if defined(__SSE2__)
  const __m128 absolute = _mm_castsi128_ps(_mm_set1_epi32(0x7fffffff)), limit = _mm_set1_ps(radius);
  const __m128 dx = _mm_and_ps(_mm_sub_ps(_mm_loadu_ps(&x_[first]), _mm_set1_ps(centre_x)), absolute);
  const __m128 dy = _mm_and_ps(_mm_sub_ps(_mm_loadu_ps(&y_[first]), _mm_set1_ps(centre_y)), absolute);
  return static_cast<unsigned>(_mm_movemask_ps(_mm_and_ps(_mm_cmplt_ps(dx, limit), _mm_cmplt_ps(dy, limit))));
#else
  unsigned near = 0;
  for (std::size_t i = 0; i < batch; ++i) {
    const bool is_near_x = std::abs(x_[first + i] - centre_x) < radius,
               is_near_y = std::abs(y_[first + i] - centre_y) < radius;
    near |= static_cast<unsigned>(is_near_x & is_near_y) << i;
  }
  return near;
#endif
}

inline void FeatureGrid::query(float centre_x, float centre_y, float radius, std::vector<std::uint32_t>& found) const {
  if (empty()) return;
  const int first_column = column_of(centre_x - radius), last_column = column_of(centre_x + radius);
  const int first_row = row_of(centre_y - radius), last_row = row_of(centre_y + radius);
  // The cells of a row are contiguous in memory: one run per row.
  const auto begin_of = [&](int row) { return cell_begin_[static_cast<std::size_t>(row) * columns_ + first_column]; };
  const auto end_of = [&](int row) { return cell_begin_[static_cast<std::size_t>(row) * columns_ + last_column + 1]; };
  std::size_t count = found.size(), most = count;
  for (int row = first_row; row <= last_row; ++row) most += end_of(row) - begin_of(row);
  found.resize(most + batch);
  for (int row = first_row; row <= last_row; ++row) {
    const std::size_t end = end_of(row);
    for (std::size_t first = begin_of(row); first < end; first += batch) {
      const unsigned near =
          near_of_batch(first, centre_x, centre_y, radius) & (0xfU >> (batch - std::min(end - first, batch)));
      // Without a branch, because no processor can predict which features are near.
      for (std::size_t i = 0; i < batch; ++i) {
        found[count] = features_[first + i];
        count += near >> i & 1U;
      }
    }
  }
  found.resize(count);
}

}  // namespace holdfast
