// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/texture.hpp"

#include <algorithm>
#include <array>

#include "holdfast/core/error.hpp"
#include "vectors.hpp"

namespace holdfast::simulation {

namespace {
// 0x00rrggbb to 16-bit lanes: weights of 8 bits then work on all channels in one multiplication.
inline std::uint64_t spread(std::uint32_t texel) {
  return (texel & 0xffULL) | ((texel & 0xff00ULL) << 8) | ((texel & 0xff0000ULL) << 16);
}
// Two neighbouring texels as eight 16-bit lanes.
using Bytes8 = std::uint8_t __attribute__((vector_size(8)));
inline Lanes8 load_pair(const std::uint32_t* texels) { return __builtin_convertvector(load<Bytes8>(texels), Lanes8); }

// Weights of interpolation by 256ths of the way: down over all lanes, and across from the first texel to the second.
struct Weights {
  alignas(16) std::array<std::array<std::uint16_t, 8>, 256> down{}, across{};
  constexpr Weights() {
    for (std::uint16_t f = 0; f < 256; ++f) {
      const auto rest = static_cast<std::uint16_t>(256 - f);
      down[f] = {f, f, f, f, f, f, f, f};
      across[f] = {rest, rest, rest, rest, f, f, f, f};
    }
  }
};
constexpr Weights interpolation;

// Adds `weight` 256ths of `count` bilinear samples.
template <int count>
inline void add_bilinear(const std::uint32_t* texels, int width, int height, Floats4 u, Floats4 v, int weight,
                         Lanes8* sums) {
  const Floats4 zero = {0, 0, 0, 0};
  const Floats4 x = smaller(larger(u - 0.5F, zero), zero + static_cast<float>(width - 1)) * 256.0F;
  const Floats4 y = smaller(larger(v - 0.5F, zero), zero + static_cast<float>(height - 1)) * 256.0F;
  const Integers4 fixed_x = __builtin_convertvector(x, Integers4), fixed_y = __builtin_convertvector(y, Integers4);
  const Integers4 widths = {width, width, width, width};
  alignas(16) std::int32_t offsets[4], across[4], down[4];
  store(offsets, product_of_shorts(fixed_y >> 8, widths) + (fixed_x >> 8));
  store(across, fixed_x & 255);
  store(down, fixed_y & 255);
  const auto share = static_cast<std::uint16_t>(weight);
  const Lanes8 shares = {share, share, share, share, share, share, share, share};
  for (int k = 0; k < count; ++k) {
    // In the last column `across` is 0: the texel after it, which may be of another row, has no weight.
    const std::uint32_t* corner = texels + offsets[k];
    const Lanes8 above = load_pair(corner), below = load_pair(corner + width);
    // Modulo 65536 on the way, within 255 * 256 at its end.
    const Lanes8 columns =
        ((above << 8) + (below - above) * load<Lanes8>(interpolation.down[down[k]].data()) + 128) >> 8;
    const Lanes8 parts = columns * load<Lanes8>(interpolation.across[across[k]].data());
    const Lanes8 value = (parts + __builtin_shufflevector(parts, parts, 4, 5, 6, 7, 0, 1, 2, 3) + 128) >> 8;
    sums[k] += value * shares;
  }
}

constexpr std::uint64_t lanes = 0x00ff00ff00ffULL;
}  // namespace

Texture::Texture(const cv::Mat& picture) {
  HOLDFAST_CHECK(!picture.empty() && picture.type() == CV_8UC3, "type " << picture.type());
  HOLDFAST_CHECK(picture.cols < 32768 && picture.rows < 32768, picture.cols << " by " << picture.rows);
  std::uint32_t total = 0;
  Level level{picture.cols, picture.rows, 0};
  for (;; ++last_level_) {
    level.begin = total;
    levels_[last_level_] = level;
    // The last row twice: interpolation in it reads one row on.
    total += static_cast<std::uint32_t>(level.width) * static_cast<std::uint32_t>(level.height + 1);
    if (level.width == 1 && level.height == 1) break;
    level.width = std::max(1, level.width / 2), level.height = std::max(1, level.height / 2);
  }
  texels_.resize(total + 1);  // interpolation in the last column reads one texel on

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
  for (int number = 0; number <= last_level_; ++number) {
    const Level& each = levels_[number];
    const auto end = texels_.begin() + each.begin + static_cast<std::ptrdiff_t>(each.width) * each.height;
    std::copy(end - each.width, end, end);
  }
}

template <int count>
void Texture::sample_some(const float* at_u, const float* at_v, const Footprint& footprint, float* colours) const {
  int fine = 0, coarse_share = 0;
  if (footprint.level > 0.0F) {
    fine = std::min(static_cast<int>(footprint.level), last_level_);
    if (fine < last_level_) coarse_share = static_cast<int>((footprint.level - static_cast<float>(fine)) * 256.0F);
  }
  // Halving drops an odd last row or column, so that texels of level k cover exactly 2^k of level 0.
  const float scale = 1.0F / static_cast<float>(1U << fine);
  const Floats4 u = load<Floats4>(at_u) * scale, v = load<Floats4>(at_v) * scale;
  const float inverse_taps = 1.0F / static_cast<float>(footprint.taps);
  Lanes8 sums[count] = {};
  for (int tap = 0; tap < footprint.taps; ++tap) {
    const float share = ((static_cast<float>(tap) + 0.5F) * inverse_taps - 0.5F) * scale;
    const Floats4 tap_u = u + share * footprint.along_u, tap_v = v + share * footprint.along_v;
    const int weight = footprint.taps == 3 ? 85 + (tap == 1) : static_cast<int>(256.0F * inverse_taps);
    const int coarse_weight = (weight * coarse_share) >> 8;
    const auto add = [&](const Level& level, float factor, int part) {
      add_bilinear<count>(texels_.data() + level.begin, level.width, level.height, tap_u * factor, tap_v * factor, part,
                          sums);
    };
    add(levels_[fine], 1.0F, weight - coarse_weight);
    if (coarse_weight > 0) add(levels_[fine + 1], 0.5F, coarse_weight);
  }
  for (int k = 0; k < count; ++k) {
    const Lanes8 zero = {};
    const auto lower = reinterpret_cast<Integers4>(__builtin_shufflevector(sums[k], zero, 0, 8, 1, 9, 2, 10, 3, 11));
    store(colours + 4 * k, __builtin_convertvector(lower, Floats4) * (1.0F / 256.0F));
  }
}

void Texture::sample(const float* u, const float* v, int count, const Footprint& footprint, float* colours) const {
  if (count == 1)
    sample_some<1>(u, v, footprint, colours);
  else if (count == 2)
    sample_some<2>(u, v, footprint, colours);
  else
    sample_some<4>(u, v, footprint, colours);
}

}  // namespace holdfast::simulation
