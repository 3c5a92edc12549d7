// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast::simulation {

/// A colour picture with its mip chain (Williams 1983: each level halves the previous one by a 2x2 mean) for sampling
/// without aliasing. Texel centres are at half-integer coordinates: texel (i, j) covers [i, i + 1) x [j, j + 1).
/// Outside the picture its border is repeated.
class Texture {
 public:
  /// `picture` is 8UC3, blue green red, and not empty.
  explicit Texture(const cv::Mat& picture);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }

  /// The footprint of a pixel in a texture.
  struct Footprint {
    float along_u = 0.0F, along_v = 0.0F;  ///< its length [texels of level 0]
    int taps = 1;                          ///< 1 to 4 samples spread over its length (anisotropic filtering)
    float level = 0.0F;                    ///< base-2 logarithm of its width [texels of level 0]
  };

  /// Trilinear samples at (u[k], v[k]) [texels of level 0], k < count <= 4, with a common footprint. Both arrays have
  /// four elements, the result sixteen: blue, green, red from 0 to 255 and 0 for each position.
  void sample(const float* u, const float* v, int count, const Footprint& footprint, float* colours) const;

 private:
  struct Level {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::uint32_t begin = 0;  // of its texels in texels_
  };
  template <int count>
  void sample_some(const float* u, const float* v, const Footprint& footprint, float* colours) const;

  int last_level_ = 0;
  std::array<Level, 16> levels_;
  std::vector<std::uint32_t> texels_;  // 0x00rrggbb, level by level: together, so that a sample costs few cache misses
};

}  // namespace holdfast::simulation
