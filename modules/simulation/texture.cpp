// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/texture.hpp"

#include <algorithm>

#include "holdfast/core/error.hpp"

namespace holdfast::simulation {

namespace {
// 0x00rrggbb to 16-bit lanes: weights of 8 bits then work on all channels in one multiplication.
inline std::uint64_t spread(std::uint32_t texel) {
  return (texel & 0xffULL) | ((texel & 0xff00ULL) << 8) | ((texel & 0xff0000ULL) << 16);
}
constexpr std::uint64_t lanes = 0x00ff00ff00ffULL;
constexpr std::uint64_t half = 0x008000800080ULL;
}  // namespace

Texture::Texture(const cv::Mat& picture) {
  HOLDFAST_CHECK(!picture.empty() && picture.type() == CV_8UC3, "type " << picture.type());
  Level& base = levels_.emplace_back();
  base.width = picture.cols, base.height = picture.rows;
  base.texels.resize(static_cast<std::size_t>(base.width) * base.height);
  for (int y = 0; y < base.height; ++y) {
    const std::uint8_t* in = picture.ptr<std::uint8_t>(y);
    std::uint32_t* out = base.texels.data() + static_cast<std::size_t>(y) * base.width;
    for (int x = 0; x < base.width; ++x, in += 3) out[x] = in[0] | in[1] << 8 | in[2] << 16;
  }
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse;
    coarse.width = std::max(1, fine.width / 2), coarse.height = std::max(1, fine.height / 2);
    coarse.texels.resize(static_cast<std::size_t>(coarse.width) * coarse.height);
    for (int y = 0; y < coarse.height; ++y) {
      const std::uint32_t* above = fine.texels.data() + static_cast<std::size_t>(2 * y) * fine.width;
      const std::uint32_t* below = 2 * y + 1 < fine.height ? above + fine.width : above;
      for (int x = 0; x < coarse.width; ++x) {
        const int left = 2 * x, right = std::min(left + 1, fine.width - 1);
        const std::uint64_t sum =
            spread(above[left]) + spread(above[right]) + spread(below[left]) + spread(below[right]) + 0x000200020002ULL;
        const std::uint64_t mean = (sum >> 2) & lanes;
        coarse.texels[static_cast<std::size_t>(y) * coarse.width + x] =
            static_cast<std::uint32_t>((mean & 0xff) | ((mean >> 8) & 0xff00) | ((mean >> 16) & 0xff0000));
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

std::uint64_t Texture::bilinear(const Level& level, float u, float v) {
  u = std::clamp(u - 0.5F, 0.0F, static_cast<float>(level.width - 1));
  v = std::clamp(v - 0.5F, 0.0F, static_cast<float>(level.height - 1));
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fx = static_cast<std::uint32_t>((u - static_cast<float>(x)) * 256.0F);
  const auto fy = static_cast<std::uint32_t>((v - static_cast<float>(y)) * 256.0F);
  const int right = x + 1 < level.width ? 1 : 0, down = y + 1 < level.height ? level.width : 0;
  const std::uint32_t* texel = level.texels.data() + static_cast<std::size_t>(y) * level.width + x;
  const std::uint64_t w11 = (fx * fy + 128) >> 8, w10 = fx - w11, w01 = fy - w11, w00 = 256 - fx - fy + w11;
  const std::uint64_t sum = spread(texel[0]) * w00 + spread(texel[right]) * w10 + spread(texel[down]) * w01 +
                            spread(texel[down + right]) * w11 + half;
  return (sum >> 8) & lanes;
}

std::uint64_t Texture::sample(float u, float v, float level) const {
  if (level <= 0.0F) return bilinear(levels_.front(), u, v);
  const int last = static_cast<int>(levels_.size()) - 1;
  const int fine = std::min(static_cast<int>(level), last);
  // Halving drops an odd last row or column, so that texels of level k cover exactly 2^k of level 0.
  const float scale = 1.0F / static_cast<float>(1U << fine);
  const std::uint64_t below = bilinear(levels_[fine], u * scale, v * scale);
  if (fine == last) return below;
  const auto weight = static_cast<std::uint64_t>((level - static_cast<float>(fine)) * 256.0F);
  const std::uint64_t above = bilinear(levels_[fine + 1], u * scale * 0.5F, v * scale * 0.5F);
  return ((below * (256 - weight) + above * weight + half) >> 8) & lanes;
}

}  // namespace holdfast::simulation
