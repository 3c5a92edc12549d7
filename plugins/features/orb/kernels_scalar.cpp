// SPDX-License-Identifier: BSD-3-Clause
// The definition of every kernel, in plain code; the vector kernels are tested against it.
#include <algorithm>
#include <cstdlib>

#include "kernels.hpp"

namespace holdfast::orb_plugin {

namespace {

std::uint8_t fast_score(const std::uint8_t* pixel, const std::ptrdiff_t* offsets, int threshold) {
  const int centre = pixel[0];
  // Of two opposite pixels one lies in every arc of nine: both near the centre's grey value rules a corner out.
  const auto is_near = [&](int i) { return std::abs(pixel[offsets[i]] - centre) <= threshold; };
  for (const int i : {0, 4, 2, 6})
    if (is_near(i) && is_near(i + 8)) return 0;

  int difference[24];
  for (int i = 0; i < 16; ++i) difference[i] = pixel[offsets[i]] - centre;
  std::copy(difference, difference + 8, difference + 16);
  int best = 0;
  for (int begin = 0; begin < 16; ++begin) {
    const auto [low, high] = std::minmax_element(difference + begin, difference + begin + 9);
    best = std::max({best, *low, -*high});
  }
  return static_cast<std::uint8_t>(best > threshold ? best - 1 : 0);
}

void fast_scores(const ImageView& region, int threshold, const OutputRows& scores) {
  std::ptrdiff_t offsets[16];
  for (int i = 0; i < 16; ++i) offsets[i] = circle[i][0] + circle[i][1] * region.stride;
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x)
      scores.data[y * scores.stride + x] = fast_score(region.at(x, y), offsets, threshold);
}

void neighbour_scores(const std::uint8_t* pixel, std::ptrdiff_t stride, std::uint8_t* scores) {
  fast_scores({pixel - stride - 1, stride, 3, 3}, 0, {scores, 3});
}

int local_maxima(const std::uint8_t* scores, std::ptrdiff_t stride, int width, std::uint16_t* columns) {
  int count = 0;
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* s = scores + x;
    if (s[0] == 0) continue;
    const int before = std::max({s[-stride - 1], s[-stride], s[-stride + 1], s[-1]});
    const int after = std::max({s[1], s[stride - 1], s[stride], s[stride + 1]});
    if (s[0] > before && s[0] >= after) columns[count++] = static_cast<std::uint16_t>(x);
  }
  return count;
}

std::uint8_t blend(int first, int second, int weight) {
  return static_cast<std::uint8_t>((first * (128 - weight) + second * weight + 64) >> 7);
}

void resize(const ImageView& input, const ResizeAxis& columns, const ResizeAxis& rows, std::uint8_t* row,
            const OutputRows& output) {
  for (std::size_t y = 0; y < rows.first.size(); ++y) {
    const std::uint8_t* upper = input.at(0, rows.first[y]);
    for (int x = 0; x < input.width; ++x) row[x] = blend(upper[x], upper[x + input.stride], rows.weight[y]);
    std::uint8_t* out = output.data + static_cast<std::ptrdiff_t>(y) * output.stride;
    for (std::size_t x = 0; x < columns.first.size(); ++x)
      out[x] = blend(row[columns.first[x]], row[columns.first[x] + 1], columns.weight[x]);
  }
}

std::uint8_t blur_at(const std::uint8_t* p, std::ptrdiff_t step) {
  const int sum = blur_weights[0] * p[0] + blur_weights[1] * (p[-step] + p[step]) +
                  blur_weights[2] * (p[-2 * step] + p[2 * step]) + blur_weights[3] * (p[-3 * step] + p[3 * step]);
  return static_cast<std::uint8_t>((sum + 64) >> 7);
}

void blur(const ImageView& input, std::uint8_t* row, const OutputRows& output) {
  for (int y = blur_radius; y < input.height - blur_radius; ++y) {
    for (int x = 0; x < input.width; ++x) row[x] = blur_at(input.at(x, y), input.stride);
    for (int x = blur_radius; x < input.width - blur_radius; ++x)
      output.data[y * output.stride + x] = blur_at(row + x, 1);
  }
}

void moments(const std::uint8_t* centre, std::ptrdiff_t stride, int& moment_x, int& moment_y) {
  moment_x = moment_y = 0;
  for (int y = -patch_radius; y <= patch_radius; ++y) {
    const int half_width = patch_half_width[std::abs(y)];
    const std::uint8_t* row = centre + y * stride;
    for (int x = -half_width; x <= half_width; ++x) {
      moment_x += x * row[x];
      moment_y += y * row[x];
    }
  }
}

void describe(const std::uint8_t* centre, const std::int32_t* offsets, Descriptor256& descriptor) {
  for (int word = 0; word < 4; ++word) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i) {
      const std::int32_t* pair = offsets + word * 64 + i;
      bits |= static_cast<std::uint64_t>(centre[pair[0]] < centre[pair[256]]) << i;
    }
    descriptor.words[word] = bits;
  }
}

}  // namespace

const Kernels& scalar_kernels() {
  static constexpr Kernels table = {fast_scores, neighbour_scores, local_maxima, resize, blur, moments, describe};
  return table;
}

}  // namespace holdfast::orb_plugin
