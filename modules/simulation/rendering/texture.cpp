// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/texture.hpp"

#include <algorithm>
#include <cstring>

#include "holdfast/core/error.hpp"

namespace holdfast::simulation {

namespace {
// 0x00rrggbb to 16-bit lanes: weights of 8 bits then work on all channels in one multiplication.
inline std::uint64_t spread(std::uint32_t texel) {
  return (texel & 0xffULL) | ((texel & 0xff00ULL) << 8) | ((texel & 0xff0000ULL) << 16);
}
// Two neighbouring texels as eight 16-bit lanes; the compiler's vectors, so that any processor's are used.
using Bytes8 = std::uint8_t __attribute__((vector_size(8)));
using Longs2 = std::uint64_t __attribute__((vector_size(16)));
using Lanes8 = std::uint16_t __attribute__((vector_size(16)));
inline Lanes8 load_pair(const std::uint32_t* texels) {
  Bytes8 bytes;
  std::memcpy(&bytes, texels, sizeof(bytes));
  return __builtin_convertvector(bytes, Lanes8);
}
inline Lanes8 weights(std::uint64_t first, std::uint64_t second) {
  constexpr std::uint64_t each = 0x0001000100010001ULL;
  const Longs2 pair = {first * each, second * each};
  return reinterpret_cast<Lanes8>(pair);
}
constexpr std::uint64_t lanes = 0x00ff00ff00ffULL;
constexpr std::uint64_t half = 0x008000800080ULL;
}  // namespace

Texture::Texture(const cv::Mat& picture) {
  HOLDFAST_CHECK(!picture.empty() && picture.type() == CV_8UC3, "type " << picture.type());
  HOLDFAST_CHECK(picture.cols < 32768 && picture.rows < 32768, picture.cols << " by " << picture.rows);
  std::uint32_t total = 0;
  Level level{picture.cols, picture.rows, 0};
  for (;; ++last_level_) {
    level.begin = total;
    levels_[last_level_] = level;
    total += static_cast<std::uint32_t>(level.width) * static_cast<std::uint32_t>(level.height);
    if (level.width == 1 && level.height == 1) break;
    level.width = std::max(1, level.width / 2), level.height = std::max(1, level.height / 2);
  }
  texels_.resize(total + 1);  // bilinear() reads one texel beyond the last

  for (int y = 0; y < picture.rows; ++y) {
    const std::uint8_t* in = picture.ptr<std::uint8_t>(y);
    std::uint32_t* out = texels_.data() + static_cast<std::size_t>(y) * picture.cols;
    for (int x = 0; x < picture.cols; ++x, in += 3) out[x] = in[0] | in[1] << 8 | in[2] << 16;
  }
  for (int number = 1; number <= last_level_; ++number) {
    const Level &fine = levels_[number - 1], &coarse = levels_[number];
    for (int y = 0; y < coarse.height; ++y) {
      const std::uint32_t* above = texels_.data() + fine.begin + static_cast<std::size_t>(2 * y) * fine.width;
      const std::uint32_t* below = 2 * y + 1 < fine.height ? above + fine.width : above;
      std::uint32_t* out = texels_.data() + coarse.begin + static_cast<std::size_t>(y) * coarse.width;
      for (int x = 0; x < coarse.width; ++x) {
        const int left = 2 * x, right = std::min(left + 1, fine.width - 1);
        const std::uint64_t sum =
            spread(above[left]) + spread(above[right]) + spread(below[left]) + spread(below[right]) + 0x000200020002ULL;
        const std::uint64_t mean = (sum >> 2) & lanes;
        out[x] = static_cast<std::uint32_t>((mean & 0xff) | ((mean >> 8) & 0xff00) | ((mean >> 16) & 0xff0000));
      }
    }
  }
}

inline std::uint64_t Texture::bilinear(const Level& level, float u, float v) const {
  u = std::clamp(u - 0.5F, 0.0F, static_cast<float>(level.width - 1));
  v = std::clamp(v - 0.5F, 0.0F, static_cast<float>(level.height - 1));
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fx = static_cast<std::uint32_t>((u - static_cast<float>(x)) * 256.0F);
  const auto fy = static_cast<std::uint32_t>((v - static_cast<float>(y)) * 256.0F);
  const std::uint32_t w11 = (fx * fy + 128) >> 8, w10 = fx - w11, w01 = fy - w11, w00 = 256 + w11 - fx - fy;
  // In the last column fx is 0: the texel after it, which may be of another row or level, has no weight.
  const std::uint32_t* above = texels_.data() + level.begin + static_cast<std::size_t>(y) * level.width + x;
  const std::uint32_t* below = y + 1 < level.height ? above + level.width : above;
  const Lanes8 top = weights(w00, w10), bottom = weights(w01, w11);
  const Lanes8 sum = load_pair(above) * top + load_pair(below) * bottom;  // at most 255 * 256
  const Longs2 halves = reinterpret_cast<Longs2>(sum);
  return ((halves[0] + halves[1] + half) >> 8) & lanes;
}

std::uint64_t Texture::sample(float u, float v, float level) const {
  if (level <= 0.0F) return bilinear(levels_[0], u, v);
  const int fine = std::min(static_cast<int>(level), last_level_);
  // Halving drops an odd last row or column, so that texels of level k cover exactly 2^k of level 0.
  const float scale = 1.0F / static_cast<float>(1U << fine);
  const std::uint64_t below = bilinear(levels_[fine], u * scale, v * scale);
  if (fine == last_level_) return below;
  const auto weight = static_cast<std::uint64_t>((level - static_cast<float>(fine)) * 256.0F);
  const std::uint64_t above = bilinear(levels_[fine + 1], u * scale * 0.5F, v * scale * 0.5F);
  return ((below * (256 - weight) + above * weight + half) >> 8) & lanes;
}

}  // namespace holdfast::simulation
