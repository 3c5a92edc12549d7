// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "brief.hpp"
#include "pyramid.hpp"

namespace holdfast::orb_plugin {

/// A FAST corner of a level.
struct Corner {
  std::uint16_t x, y;  ///< [px of the level]
  std::uint8_t score;  ///< largest threshold at which it is a corner
};

/// FAST-9 corners of one level, maxima of their 3 x 3 neighbourhood. Cells in which the threshold finds nothing are
/// searched again with the low one (Mur-Artal et al. 2015, section IV), so that weak texture gets features too.
class CornerDetector {
 public:
  /// Distance from the border within which no corner is taken: the blur around the outermost sample of the descriptor
  /// must fit, and the orientation patch.
  static constexpr int border = brief_radius + blur_radius;
  static_assert(border > patch_radius);
  static constexpr int minimum_image_size = 2 * border + 1;

  /// A low threshold that is not below the other switches the second search off. Sizes in pixels of the level.
  CornerDetector(int threshold, int low_threshold, int cell_size, const Kernels& kernels)
      : threshold_(threshold), low_threshold_(low_threshold), cell_size_(cell_size), kernels_(kernels) {}

  /// Replaces `corners` by those of the image; `is_ignored(x, y)` drops a corner before it can claim a cell.
  template <class IsIgnored>
  void detect(const ImageView& image, const IsIgnored& is_ignored, std::vector<Corner>& corners) {
    begin(image);
    corners.clear();
    search(image, {0, 0, width_, height_}, threshold_, is_ignored, corners);
    if (low_threshold_ >= threshold_) return;
    find_empty_cells(corners);
    for (const Region& region : empty_) score(image, region, low_threshold_);
    for (const Region& region : empty_) collect(region, is_ignored, corners);
  }

 private:
  /// Of the searched part of the image, whose origin is (border, border).
  struct Region {
    int x, y, width, height;
  };

  template <class IsIgnored>
  void search(const ImageView& image, const Region& region, int threshold, const IsIgnored& is_ignored,
              std::vector<Corner>& corners) {
    score(image, region, threshold);
    collect(region, is_ignored, corners);
  }

  template <class IsIgnored>
  void collect(const Region& region, const IsIgnored& is_ignored, std::vector<Corner>& corners) {
    for (int y = region.y; y < region.y + region.height; ++y) {
      const std::uint8_t* row = scores_.data() + (y + 1) * score_stride_ + 1 + region.x;
      const int found = kernels_.local_maxima(row, score_stride_, region.width, columns_.data());
      for (int i = 0; i < found; ++i) {
        const int x = border + region.x + columns_[i];
        if (!is_ignored(x, border + y))
          corners.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(border + y), row[columns_[i]]});
      }
    }
  }

  void begin(const ImageView& image);
  void score(const ImageView& image, const Region& region, int threshold);
  void find_empty_cells(const std::vector<Corner>& corners);

  int threshold_, low_threshold_, cell_size_;
  const Kernels& kernels_;
  int width_ = 0, height_ = 0;  // of the searched part
  std::ptrdiff_t score_stride_ = 0;
  std::vector<std::uint8_t> scores_;  // with a frame of zeros, one pixel wide
  std::vector<std::uint16_t> columns_;
  std::vector<std::uint16_t> cell_column_, cell_row_;  // of a position
  std::vector<std::uint8_t> is_occupied_;
  std::vector<Region> empty_;
};

}  // namespace holdfast::orb_plugin
