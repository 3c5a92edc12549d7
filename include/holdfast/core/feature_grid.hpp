// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace holdfast {

/// Features by position: a counting sort into square cells, so that a search window visits only the features near it.
class FeatureGrid {
 public:
  /// Sorts features into cells. Those outside [min, max] go to the border cells.
  void build(std::span<const float> x, std::span<const float> y, float minimum_x, float minimum_y, float maximum_x,
             float maximum_y, float cell_size = 20.0F);

  /// Appends to `found` the features with |x - centre_x| < radius and |y - centre_y| < radius, ordered by cell (row by
  /// row), then by index.
  void query(float centre_x, float centre_y, float radius, std::span<const float> x, std::span<const float> y,
             std::vector<std::uint32_t>& found) const;

  bool empty() const { return features_.empty(); }
  /// Whether a position lies within the bounds given to build.
  bool covers(float x, float y) const {
    return x >= minimum_x_ && x <= maximum_x_ && y >= minimum_y_ && y <= maximum_y_;
  }

 private:
  int column_of(float x) const;
  int row_of(float y) const;

  float minimum_x_ = 0, minimum_y_ = 0, maximum_x_ = 0, maximum_y_ = 0, inverse_cell_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cell_begin_;  // per cell, plus one
  std::vector<std::uint32_t> features_;    // by cell
};

}  // namespace holdfast
