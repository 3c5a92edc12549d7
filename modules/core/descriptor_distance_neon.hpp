// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <arm_neon.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "holdfast/core/descriptor.hpp"

/// Distances of whole numbers by NEON's own instructions. GCC makes an addition across the vector of each
/// std::popcount, and no widening products of bytes. Sums of whole numbers are exact in any order, so that the
/// distances have the bits of the scalar kernels. Numbers in floating point need no kernel: every aarch64 build
/// computes on NEON's vectors.
namespace holdfast::neon {

#define HOLDFAST_INLINE __attribute__((always_inline)) static inline

/// The differing bits of each pair of bytes that lie 16 apart: at most 16.
HOLDFAST_INLINE uint8x16_t differing_bits(const Descriptor256* a, const Descriptor256* b) {
  const auto* x = reinterpret_cast<const std::uint8_t*>(a);
  const auto* y = reinterpret_cast<const std::uint8_t*>(b);
  return vaddq_u8(vcntq_u8(veorq_u8(vld1q_u8(x), vld1q_u8(y))), vcntq_u8(veorq_u8(vld1q_u8(x + 16), vld1q_u8(y + 16))));
}

/// Hamming distance of 256 bits.
struct Bits256 {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t) {
    return static_cast<float>(vaddlvq_u8(differing_bits(a, b)));
  }
};

/// Hamming distance of any number of bits.
struct Bits {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    uint32x4_t sums = vdupq_n_u32(0);
    for (std::size_t unit = 0; unit < units; ++unit)
      sums = vpadalq_u16(sums, vpaddlq_u8(differing_bits(a + unit, b + unit)));
    return static_cast<float>(static_cast<int>(vaddvq_u32(sums)));
  }
};

struct Int8Euclidean {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* x = reinterpret_cast<const std::int8_t*>(a);
    const auto* y = reinterpret_cast<const std::int8_t*>(b);
    uint32x4_t sums = vdupq_n_u32(0);
    for (std::size_t i = 0; i < units * sizeof(Descriptor256); i += 16) {
      const uint8x16_t apart = vreinterpretq_u8_s8(vabdq_s8(vld1q_s8(x + i), vld1q_s8(y + i)));
      sums = vpadalq_u16(sums, vmull_u8(vget_low_u8(apart), vget_low_u8(apart)));
      sums = vpadalq_u16(sums, vmull_high_u8(apart, apart));
    }
    return std::sqrt(static_cast<float>(static_cast<int>(vaddvq_u32(sums))));
  }
};

/// sums + the products of 16 pairs of numbers
HOLDFAST_INLINE int32x4_t add_products(int32x4_t sums, int8x16_t a, int8x16_t b) {
  sums = vpadalq_s16(sums, vmull_s8(vget_low_s8(a), vget_low_s8(b)));
  return vpadalq_s16(sums, vmull_high_s8(a, b));
}

struct Int8Cosine {
  HOLDFAST_INLINE float of(const Descriptor256* a, const Descriptor256* b, std::size_t units) {
    const auto* x = reinterpret_cast<const std::int8_t*>(a);
    const auto* y = reinterpret_cast<const std::int8_t*>(b);
    int32x4_t products = vdupq_n_s32(0), lengths_a = products, lengths_b = products;
    for (std::size_t i = 0; i < units * sizeof(Descriptor256); i += 16) {
      const int8x16_t of_a = vld1q_s8(x + i), of_b = vld1q_s8(y + i);
      products = add_products(products, of_a, of_b);
      lengths_a = add_products(lengths_a, of_a, of_a);
      lengths_b = add_products(lengths_b, of_b, of_b);
    }
    const int length_a = vaddvq_s32(lengths_a), length_b = vaddvq_s32(lengths_b);
    if (length_a == 0 || length_b == 0) return 1.0F;
    return 1.0F - static_cast<float>(vaddvq_s32(products)) /
                      (std::sqrt(static_cast<float>(length_a)) * std::sqrt(static_cast<float>(length_b)));
  }
};

#undef HOLDFAST_INLINE

}  // namespace holdfast::neon
