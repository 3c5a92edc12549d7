// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "eight_words.hpp"

namespace holdfast {

/// Sums of absolute differences of a pair, in a square window around each pixel of the left image, at the disparity
/// that was found at half the resolution and at its neighbours, as one vector of eight lanes for each pixel. Windows
/// follow the disparities found; outside the image they are mirrored (BORDER_REFLECT_101). Rows are computed one by one
/// from running sums, so that only those of one window are kept.
class WindowCosts {
 public:
  static constexpr int reach = 2;  ///< px; the neighbours on each side
  static constexpr int candidates = 2 * reach + 1;
  static constexpr int window = 9;   ///< px
  static constexpr int eighths = 8;  ///< of a pixel: the unit of disparities
  /// Costs of one pixel: lane k belongs to the disparity found + reach - k; lanes without a candidate are of no use.
  using Lanes = EightWords;

  /// `left`, `right`: 8UC1, of the same mean brightness. `half_disparity`: 16SC1 of half the size
  /// [1/8 px of the full resolution]; less than 1 px: unknown. They must not change until the last row.
  void begin(const cv::Mat& left, const cv::Mat& right, const cv::Mat& half_disparity);
  /// The costs of the next row, by column, and seven more that are of no use; valid until the next call. At most as
  /// many calls as there are rows.
  const Lanes* next_row();

  /// The disparities at half the resolution that belong to a row of the full one.
  static const std::int16_t* half_row(const cv::Mat& half, int row) {
    return half.ptr<std::int16_t>(std::min(row / 2, half.rows - 1));
  }

 private:
  static constexpr int kept_rows = 16, radius = window / 2;

  Lanes* differences_of(int row);
  void compare(int row);
  void add(int row, int sign);

  cv::Mat left_, right_, half_disparity_;
  int row_ = 0, compared_ = 0;           // the next row of costs; rows that have been compared
  std::vector<std::uint8_t> right_row_;  // with what vectors read beyond its end
  std::vector<Lanes> differences_;       // of the latest rows, in a ring
  std::vector<Lanes> column_sums_, costs_;
};

}  // namespace holdfast
