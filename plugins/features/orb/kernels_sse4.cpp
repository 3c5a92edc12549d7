// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__x86_64__)
#include <smmintrin.h>

#define HOLDFAST_TARGET __attribute__((target("sse4.1,popcnt")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

namespace holdfast::orb_plugin {
namespace {

const Kernels& narrower_kernels() { return scalar_kernels(); }

/// Operations on 16 bytes.
struct Simd {
  using Vector = __m128i;
  static constexpr int bytes = 16;
  HOLDFAST_TARGET_INLINE static Vector load(const void* p) { return _mm_loadu_si128(static_cast<const Vector*>(p)); }
  HOLDFAST_TARGET_INLINE static void store(void* p, Vector v) { _mm_storeu_si128(static_cast<Vector*>(p), v); }
  HOLDFAST_TARGET_INLINE static Vector fill(int value) { return _mm_set1_epi8(static_cast<char>(value)); }
  HOLDFAST_TARGET_INLINE static Vector minimum(Vector a, Vector b) { return _mm_min_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector maximum(Vector a, Vector b) { return _mm_max_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector subtract(Vector a, Vector b) { return _mm_subs_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector bit_or(Vector a, Vector b) { return _mm_or_si128(a, b); }
  HOLDFAST_TARGET_INLINE static Vector and_not(Vector a, Vector b) { return _mm_andnot_si128(a, b); }
  HOLDFAST_TARGET_INLINE static Vector equal(Vector a, Vector b) { return _mm_cmpeq_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static bool any(Vector v) { return _mm_testz_si128(v, v) == 0; }
  HOLDFAST_TARGET_INLINE static std::uint32_t mask(Vector v) {
    return static_cast<std::uint32_t>(_mm_movemask_epi8(v));
  }
  HOLDFAST_TARGET_INLINE static Vector fill16(int value) { return _mm_set1_epi16(static_cast<short>(value)); }
  HOLDFAST_TARGET_INLINE static Vector fill_pairs(int first, int second) { return fill16(first | second << 8); }
  HOLDFAST_TARGET_INLINE static Vector interleave_low(Vector a, Vector b) { return _mm_unpacklo_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector interleave_high(Vector a, Vector b) { return _mm_unpackhi_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) { return _mm_maddubs_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) { return _mm_add_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector shift_right16(Vector v) { return _mm_srli_epi16(v, 7); }
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return _mm_packus_epi16(low, high); }
  HOLDFAST_TARGET_INLINE static Vector widen(Vector v) { return _mm_madd_epi16(v, _mm_set1_epi16(1)); }
  HOLDFAST_TARGET_INLINE static Vector add32(Vector a, Vector b) { return _mm_add_epi32(a, b); }
  HOLDFAST_TARGET_INLINE static int sum32(Vector v) {
    v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0x4e));
    v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0xb1));
    return _mm_cvtsi128_si32(v);
  }
};

#include "kernels_vector.inl"

HOLDFAST_TARGET void neighbour_scores(const std::uint8_t* pixel, std::ptrdiff_t stride, std::uint8_t* scores) {
  std::ptrdiff_t offsets[16];
  for (int i = 0; i < 16; ++i) offsets[i] = circle[i][0] + circle[i][1] * stride;
  for (int row = 0; row < 3; ++row) {
    const std::uint8_t* first = pixel + (row - 1) * stride - 1;
    Vector p[16];
    for (int i = 0; i < 16; ++i) p[i] = Simd::load(first + offsets[i]);
    const Vector score = Simd::subtract(exact_scores(Simd::load(first), p), Simd::fill(1));
    const int three = _mm_cvtsi128_si32(score);
    for (int i = 0; i < 3; ++i) scores[3 * row + i] = static_cast<std::uint8_t>(three >> (8 * i));
  }
}

}  // namespace

const Kernels& sse4_kernels() {
  // There is no gather below AVX2: plain loads describe.
  static const Kernels table = {fast_scores, neighbour_scores,         local_maxima, resize, blur,
                                moments,     scalar_kernels().describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
