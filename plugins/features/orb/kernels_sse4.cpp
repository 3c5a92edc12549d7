// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__x86_64__)
#include <smmintrin.h>

#include <cstring>
#include <utility>

#define HOLDFAST_TARGET __attribute__((target("sse4.1,popcnt")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

namespace holdfast::orb_plugin {
namespace {

const Kernels& narrower_kernels() { return scalar_kernels(); }

/// Operations on 16 bytes.
struct Simd {
  using Bits = std::uint32_t;
  using Vector = __m128i;
  using Pairs = Vector;        ///< bytes of two vectors, alternating
  using PairWeights = Vector;  ///< two weights, alternating
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
  HOLDFAST_TARGET_INLINE static Bits mask(Vector v) { return static_cast<Bits>(_mm_movemask_epi8(v)); }
  HOLDFAST_TARGET_INLINE static Vector fill16(int value) { return _mm_set1_epi16(static_cast<short>(value)); }
  HOLDFAST_TARGET_INLINE static Vector fill_pairs(int first, int second) { return fill16(first | second << 8); }
  HOLDFAST_TARGET_INLINE static Vector interleave_low(Vector a, Vector b) { return _mm_unpacklo_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector interleave_high(Vector a, Vector b) { return _mm_unpackhi_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) { return _mm_maddubs_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) { return _mm_add_epi16(a, b); }
  /// Rounded: (v + 64) / 128.
  HOLDFAST_TARGET_INLINE static Vector divide_by_128(Vector v) { return _mm_mulhrs_epi16(v, fill16(256)); }
  HOLDFAST_TARGET_INLINE static Vector to_high_bytes(Vector v) { return _mm_slli_epi16(v, 8); }
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return _mm_packus_epi16(low, high); }
  /// Blocks of 16 bytes, and the 8 bytes that each becomes.
  static constexpr int blocks = 1;
  HOLDFAST_TARGET_INLINE static Vector load_blocks(const std::uint8_t* row, const int* begin) {
    return load(row + begin[0]);
  }
  HOLDFAST_TARGET_INLINE static void store_blocks(std::uint8_t* p, Vector v) {
    _mm_storel_epi64(reinterpret_cast<__m128i*>(p), _mm_packus_epi16(v, v));
  }
  HOLDFAST_TARGET_INLINE static Vector shuffle(Vector v, Vector from) { return _mm_shuffle_epi8(v, from); }
  HOLDFAST_TARGET_INLINE static Vector widen(Vector v) { return _mm_madd_epi16(v, _mm_set1_epi16(1)); }
  HOLDFAST_TARGET_INLINE static Vector add32(Vector a, Vector b) { return _mm_add_epi32(a, b); }
  HOLDFAST_TARGET_INLINE static int sum32(Vector v) {
    v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0x4e));
    v = _mm_add_epi32(v, _mm_shuffle_epi32(v, 0xb1));
    return _mm_cvtsi128_si32(v);
  }
};

#include "kernels_any_width.inl"
#include "kernels_vector.inl"

/// Four pixels of each of three rows, which begin left of a pixel.
HOLDFAST_TARGET_INLINE Vector three_rows(const std::uint8_t* pixel, std::ptrdiff_t stride) {
  const auto four = [pixel](std::ptrdiff_t offset) {
    int pixels;
    std::memcpy(&pixels, pixel + offset - 1, sizeof pixels);
    return pixels;
  };
  return _mm_insert_epi32(_mm_insert_epi32(_mm_cvtsi32_si128(four(-stride)), four(0), 1), four(stride), 2);
}

HOLDFAST_TARGET void neighbour_scores(const std::uint8_t* pixel, std::ptrdiff_t stride, std::uint8_t* scores) {
  Vector p[16];
  for (int i = 0; i < 16; ++i) p[i] = three_rows(pixel + circle[i][0] + circle[i][1] * stride, stride);
  const Vector score = Simd::subtract(exact_scores(three_rows(pixel, stride), p), Simd::fill(1));
  const Vector nine = _mm_shuffle_epi8(score, _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, -1, -1, -1, -1, -1, -1, -1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(scores), nine);
  scores[8] = static_cast<std::uint8_t>(_mm_extract_epi8(nine, 8));
}

template <int... lane>
HOLDFAST_TARGET_INLINE Vector pixels_at(const std::uint8_t* centre, const std::int32_t* offsets,
                                        std::integer_sequence<int, lane...>) {
  Vector pixels = Simd::fill(0);
  ((pixels = _mm_insert_epi8(pixels, centre[offsets[lane]], lane)), ...);
  return pixels;
}

HOLDFAST_TARGET void describe(const std::uint8_t* centre, const std::int32_t* offsets, Descriptor256& descriptor) {
  constexpr auto lanes = std::make_integer_sequence<int, bytes>();
  for (int word = 0; word < 4; ++word) {
    std::uint64_t bits = 0;
    for (int group = 0; group < 64; group += bytes, offsets += bytes) {
      const Vector a = pixels_at(centre, offsets, lanes), b = pixels_at(centre, offsets + 256, lanes);
      const std::uint32_t not_less = Simd::mask(Simd::equal(Simd::maximum(a, b), a));
      bits |= static_cast<std::uint64_t>(~not_less & 0xffffU) << group;
    }
    descriptor.words[word] = bits;
  }
}

}  // namespace

const Kernels& sse4_kernels() {
  static constexpr Kernels table = {fast_scores, neighbour_scores, local_maxima, resize, blur, moments, describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
