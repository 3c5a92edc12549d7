// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__aarch64__)
#include <arm_neon.h>

#include <cstring>
#include <utility>

// Every aarch64 processor has NEON, so that no function needs a target of its own.
#define HOLDFAST_TARGET
#define HOLDFAST_TARGET_INLINE __attribute__((always_inline)) inline

namespace holdfast::orb_plugin {
namespace {

const Kernels& narrower_kernels() { return scalar_kernels(); }

/// Operations on 16 bytes. Vectors of 16-bit and 32-bit numbers are kept as bytes, too, as kernels_any_width.inl
/// expects; a cast costs no instruction.
struct Simd {
  using Bits = std::uint32_t;
  using Vector = uint8x16_t;
  static constexpr int bytes = 16;
  /// Bytes of two vectors that would alternate, apart: NEON multiplies and widens in one instruction.
  struct Pairs {
    uint8x8_t first, second;
  };
  struct PairWeights {
    uint8x8_t first, second;
  };
  HOLDFAST_TARGET_INLINE static Vector load(const void* p) { return vld1q_u8(static_cast<const std::uint8_t*>(p)); }
  HOLDFAST_TARGET_INLINE static void store(void* p, Vector v) { vst1q_u8(static_cast<std::uint8_t*>(p), v); }
  HOLDFAST_TARGET_INLINE static Vector fill(int value) { return vdupq_n_u8(static_cast<std::uint8_t>(value)); }
  HOLDFAST_TARGET_INLINE static Vector minimum(Vector a, Vector b) { return vminq_u8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector maximum(Vector a, Vector b) { return vmaxq_u8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector subtract(Vector a, Vector b) { return vqsubq_u8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector bit_or(Vector a, Vector b) { return vorrq_u8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector and_not(Vector a, Vector b) { return vbicq_u8(b, a); }
  HOLDFAST_TARGET_INLINE static Vector equal(Vector a, Vector b) { return vceqq_u8(a, b); }
  HOLDFAST_TARGET_INLINE static bool any(Vector v) { return vmaxvq_u32(vreinterpretq_u32_u8(v)) != 0; }
  /// Bit i is set where all bits of byte i are; bytes are 0 or 255.
  HOLDFAST_TARGET_INLINE static Bits mask(Vector v) {
    constexpr std::uint8_t of_byte[16] = {1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const Vector bits = vandq_u8(v, vld1q_u8(of_byte));
    return static_cast<Bits>(vaddv_u8(vget_low_u8(bits))) | static_cast<Bits>(vaddv_u8(vget_high_u8(bits))) << 8;
  }
  HOLDFAST_TARGET_INLINE static PairWeights fill_pairs(int first, int second) {
    return {vdup_n_u8(static_cast<std::uint8_t>(first)), vdup_n_u8(static_cast<std::uint8_t>(second))};
  }
  HOLDFAST_TARGET_INLINE static Pairs interleave_low(Vector a, Vector b) { return {vget_low_u8(a), vget_low_u8(b)}; }
  HOLDFAST_TARGET_INLINE static Pairs interleave_high(Vector a, Vector b) { return {vget_high_u8(a), vget_high_u8(b)}; }
  /// Sums of products of pairs. No sum of the kernels exceeds 16 bits (the largest is 255 * 128).
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Pairs pairs, PairWeights weights) {
    return vreinterpretq_u8_u16(vmlal_u8(vmull_u8(pairs.first, weights.first), pairs.second, weights.second));
  }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector v, PairWeights weights) {
    const Pairs pairs = {vmovn_u16(vreinterpretq_u16_u8(v)), vshrn_n_u16(vreinterpretq_u16_u8(v), 8)};
    return multiply_pairs(pairs, weights);
  }
  /// The same with weights of their own, which may be negative.
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) {
    const int8x16_t weights = vreinterpretq_s8_u8(b);
    const int16x8_t low = vmulq_s16(vreinterpretq_s16_u16(vmovl_u8(vget_low_u8(a))), vmovl_s8(vget_low_s8(weights)));
    const int16x8_t high = vmulq_s16(vreinterpretq_s16_u16(vmovl_high_u8(a)), vmovl_high_s8(weights));
    return vreinterpretq_u8_s16(vpaddq_s16(low, high));
  }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) {
    return vreinterpretq_u8_u16(vaddq_u16(vreinterpretq_u16_u8(a), vreinterpretq_u16_u8(b)));
  }
  /// Rounded: (v + 64) / 128.
  HOLDFAST_TARGET_INLINE static Vector divide_by_128(Vector v) {
    return vreinterpretq_u8_u16(vrshrq_n_u16(vreinterpretq_u16_u8(v), 7));
  }
  HOLDFAST_TARGET_INLINE static Vector to_high_bytes(Vector v) {
    return vreinterpretq_u8_u16(vshlq_n_u16(vreinterpretq_u16_u8(v), 8));
  }
  /// The low bytes of 16-bit numbers that are at most 255.
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return vuzp1q_u8(low, high); }
  /// Blocks of 16 bytes, and the 8 bytes that each becomes.
  static constexpr int blocks = 1;
  HOLDFAST_TARGET_INLINE static Vector load_blocks(const std::uint8_t* row, const int* begin) {
    return load(row + begin[0]);
  }
  HOLDFAST_TARGET_INLINE static void store_blocks(std::uint8_t* p, Vector v) {
    vst1_u8(p, vmovn_u16(vreinterpretq_u16_u8(v)));
  }
  HOLDFAST_TARGET_INLINE static Vector shuffle(Vector v, Vector from) { return vqtbl1q_u8(v, from); }
  HOLDFAST_TARGET_INLINE static Vector widen(Vector v) {
    return vreinterpretq_u8_s32(vpaddlq_s16(vreinterpretq_s16_u8(v)));
  }
  HOLDFAST_TARGET_INLINE static Vector add32(Vector a, Vector b) {
    return vreinterpretq_u8_u32(vaddq_u32(vreinterpretq_u32_u8(a), vreinterpretq_u32_u8(b)));
  }
  HOLDFAST_TARGET_INLINE static int sum32(Vector v) { return vaddvq_s32(vreinterpretq_s32_u8(v)); }
};

#include "kernels_any_width.inl"
#include "kernels_vector.inl"

/// Four pixels of each of three rows, which begin left of a pixel.
HOLDFAST_TARGET_INLINE Vector three_rows(const std::uint8_t* pixel, std::ptrdiff_t stride) {
  uint32x4_t rows = vdupq_n_u32(0);
  const auto four = [pixel](std::ptrdiff_t offset) {
    std::uint32_t pixels;
    std::memcpy(&pixels, pixel + offset - 1, sizeof pixels);
    return pixels;
  };
  rows = vsetq_lane_u32(four(-stride), rows, 0);
  rows = vsetq_lane_u32(four(0), rows, 1);
  return vreinterpretq_u8_u32(vsetq_lane_u32(four(stride), rows, 2));
}

HOLDFAST_TARGET void neighbour_scores(const std::uint8_t* pixel, std::ptrdiff_t stride, std::uint8_t* scores) {
  Vector p[16];
  for (int i = 0; i < 16; ++i) p[i] = three_rows(pixel + circle[i][0] + circle[i][1] * stride, stride);
  const Vector score = Simd::subtract(exact_scores(three_rows(pixel, stride), p), Simd::fill(1));
  constexpr std::uint8_t three_of_four[16] = {0, 1, 2, 4, 5, 6, 8, 9, 10, 255, 255, 255, 255, 255, 255, 255};
  const Vector nine = Simd::shuffle(score, Simd::load(three_of_four));
  vst1_u8(scores, vget_low_u8(nine));
  scores[8] = vgetq_lane_u8(nine, 8);
}

template <int... lane>
HOLDFAST_TARGET_INLINE Vector pixels_at(const std::uint8_t* centre, const std::int32_t* offsets,
                                        std::integer_sequence<int, lane...>) {
  Vector pixels = Simd::fill(0);
  ((pixels = vld1q_lane_u8(centre + offsets[lane], pixels, lane)), ...);
  return pixels;
}

HOLDFAST_TARGET void describe(const std::uint8_t* centre, const std::int32_t* offsets, Descriptor256& descriptor) {
  constexpr auto lanes = std::make_integer_sequence<int, bytes>();
  for (int word = 0; word < 4; ++word) {
    std::uint64_t bits = 0;
    for (int group = 0; group < 64; group += bytes, offsets += bytes) {
      const Vector a = pixels_at(centre, offsets, lanes), b = pixels_at(centre, offsets + 256, lanes);
      bits |= static_cast<std::uint64_t>(Simd::mask(vcltq_u8(a, b))) << group;
    }
    descriptor.words[word] = bits;
  }
}

}  // namespace

const Kernels& neon_kernels() {
  static constexpr Kernels table = {fast_scores, neighbour_scores, local_maxima, resize, blur, moments, describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
