// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/simd.hpp"

namespace holdfast::orb_plugin {

/// The circle of radius 3 around a pixel (Bresenham), clockwise from the top: column and row offsets.
inline constexpr std::array<std::array<int, 2>, 16> circle = {{{0, -3},
                                                               {1, -3},
                                                               {2, -2},
                                                               {3, -1},
                                                               {3, 0},
                                                               {3, 1},
                                                               {2, 2},
                                                               {1, 3},
                                                               {0, 3},
                                                               {-1, 3},
                                                               {-2, 2},
                                                               {-3, 1},
                                                               {-3, 0},
                                                               {-3, -1},
                                                               {-2, -2},
                                                               {-1, -3}}};

/// Radius of the patch that gives a feature its orientation [px of the level].
inline constexpr int patch_radius = 15;
/// Half widths of the rows of that patch, from the middle row outwards: the disc x^2 + y^2 < (radius + 0.5)^2.
inline constexpr auto patch_half_width = [] {
  std::array<int, patch_radius + 1> half_width{};
  for (int y = 0; y <= patch_radius; ++y)
    while (4 * ((half_width[y] + 1) * (half_width[y] + 1) + y * y) < (2 * patch_radius + 1) * (2 * patch_radius + 1))
      ++half_width[y];
  return half_width;
}();

/// Gaussian of sigma 2 px, 7 taps (middle first), in 1/128.
inline constexpr std::array<int, 4> blur_weights = {28, 24, 17, 9};
inline constexpr int blur_radius = 3;

/// How a bilinear reduction reads its input: output i lies between inputs first[i] and first[i] + 1, the second of
/// which has the weight weight[i] / 128, 1 to 127. Pixel centres correspond: input = (output + 0.5) * ratio - 0.5.
struct ResizeAxis {
  std::vector<int> first;
  std::vector<std::uint8_t> weight;
  /// Per block of 8 outputs, for the vector kernels: its first output, where its 16 input bytes begin, which of them to
  /// take (pairs), and the pairs' weights. Blocks come in adjacent pairs, of which the last overlaps the one before.
  /// Empty when 8 outputs need more than 16 inputs (ratios above about 2), and for fewer than 16 outputs.
  std::vector<int> block_output, block_begin;
  std::vector<std::array<std::uint8_t, 16>> block_shuffle;
  std::vector<std::array<std::int8_t, 16>> block_weights;

  void build(int input_size, int output_size);
};

/// View of a grey image; it does not own the pixels.
struct ImageView {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0, height = 0;

  const std::uint8_t* at(int x, int y) const { return data + y * stride + x; }
};

/// Where a kernel writes rows of bytes.
struct OutputRows {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;
};

/// The inner loops of the extractor. All are integer and give the same bytes at every level. Strides are in bytes.
struct Kernels {
  /// Scores of FAST-9 of 16 (Rosten and Drummond 2006): the largest threshold at which the pixel is a corner, 0 where
  /// that is below `threshold` (1 to 254). Reads 3 pixels beyond the region on each side.
  void (*fast_scores)(const ImageView& region, int threshold, const OutputRows& scores);
  /// Scores of a pixel and its eight neighbours, row by row, without a threshold. Reads 5 pixels to the right.
  void (*neighbour_scores)(const std::uint8_t* pixel, std::ptrdiff_t stride, std::uint8_t* scores);
  /// Columns of a row of scores that are maxima of their 3 x 3 neighbourhood (of equal neighbours the first in reading
  /// order), ascending; returns how many. Reads one score beyond the row on each side.
  int (*local_maxima)(const std::uint8_t* scores, std::ptrdiff_t stride, int width, std::uint16_t* columns);
  /// Bilinear reduction. `row` has room for the input width plus 32.
  void (*resize)(const ImageView& input, const ResizeAxis& columns, const ResizeAxis& rows, std::uint8_t* row,
                 const OutputRows& output);
  /// Gaussian blur of all pixels that are blur_radius or more from the border; the others are left alone. `rows` has
  /// room for twice the width.
  void (*blur)(const ImageView& input, std::uint8_t* rows, const OutputRows& output);
  /// First moments of the disc around a pixel: sums of column * grey and row * grey, from the centre. Reads 16 pixels
  /// to the right.
  void (*moments)(const std::uint8_t* centre, std::ptrdiff_t stride, int& moment_x, int& moment_y);
  /// Bit i is set where centre[offsets[i]] < centre[offsets[256 + i]].
  void (*describe)(const std::uint8_t* centre, const std::int32_t* offsets, Descriptor256& descriptor);
};

/// The kernels of a level; a level that this build or processor lacks is a broken promise of the caller.
const Kernels& kernels(SimdLevel level);

const Kernels& scalar_kernels();
#if defined(__x86_64__)
const Kernels& sse4_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();
#elif defined(__aarch64__)
const Kernels& neon_kernels();
#endif

}  // namespace holdfast::orb_plugin
