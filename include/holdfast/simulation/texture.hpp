// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast::simulation {

/// A colour picture with its mip chain (Williams 1983: each level halves the one before by a 2x2 mean), so that
/// sampling never aliases. Texel centres lie at half coordinates: texel (i, j) covers [i, i + 1) x [j, j + 1). Outside
/// the picture its border goes on.
class Texture {
 public:
  /// From 8UC3, blue green red, not empty.
  explicit Texture(const cv::Mat& picture);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }

  /// Trilinear sample at (u, v) [texels of level 0]; `level` is the base-2 logarithm of the footprint. The result holds
  /// blue, green, red in 16-bit lanes, lowest first, each 0 to 255.
  std::uint64_t sample(float u, float v, float level) const;

 private:
  struct Level {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::uint32_t begin = 0;  // of its texels in texels_
  };
  std::uint64_t bilinear(const Level& level, float u, float v) const;

  int last_level_ = 0;
  std::array<Level, 16> levels_;
  std::vector<std::uint32_t> texels_;  // 0x00rrggbb, level by level: together, so that a sample costs few cache misses
};

}  // namespace holdfast::simulation
