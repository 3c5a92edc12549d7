// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#define HOLDFAST_TARGET __attribute__((target("avx2,popcnt")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

namespace holdfast::orb_plugin {
namespace {

const Kernels& narrower_kernels() { return sse4_kernels(); }

/// Operations on 32 bytes. interleave_* and pack work within halves of 16 bytes; one undoes the other.
struct Simd {
  using Bits = std::uint32_t;
  using Vector = __m256i;
  using Pairs = Vector;        ///< bytes of two vectors, alternating
  using PairWeights = Vector;  ///< two weights, alternating
  static constexpr int bytes = 32;
  HOLDFAST_TARGET_INLINE static Vector load(const void* p) { return _mm256_loadu_si256(static_cast<const Vector*>(p)); }
  HOLDFAST_TARGET_INLINE static void store(void* p, Vector v) { _mm256_storeu_si256(static_cast<Vector*>(p), v); }
  HOLDFAST_TARGET_INLINE static Vector fill(int value) { return _mm256_set1_epi8(static_cast<char>(value)); }
  HOLDFAST_TARGET_INLINE static Vector minimum(Vector a, Vector b) { return _mm256_min_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector maximum(Vector a, Vector b) { return _mm256_max_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector subtract(Vector a, Vector b) { return _mm256_subs_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector bit_or(Vector a, Vector b) { return _mm256_or_si256(a, b); }
  HOLDFAST_TARGET_INLINE static Vector and_not(Vector a, Vector b) { return _mm256_andnot_si256(a, b); }
  HOLDFAST_TARGET_INLINE static Vector equal(Vector a, Vector b) { return _mm256_cmpeq_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static bool any(Vector v) { return _mm256_testz_si256(v, v) == 0; }
  HOLDFAST_TARGET_INLINE static Bits mask(Vector v) { return static_cast<Bits>(_mm256_movemask_epi8(v)); }
  HOLDFAST_TARGET_INLINE static Vector fill16(int value) { return _mm256_set1_epi16(static_cast<short>(value)); }
  HOLDFAST_TARGET_INLINE static Vector fill_pairs(int first, int second) { return fill16(first | second << 8); }
  HOLDFAST_TARGET_INLINE static Vector interleave_low(Vector a, Vector b) { return _mm256_unpacklo_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector interleave_high(Vector a, Vector b) { return _mm256_unpackhi_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) { return _mm256_maddubs_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) { return _mm256_add_epi16(a, b); }
  /// Rounded: (v + 64) / 128.
  HOLDFAST_TARGET_INLINE static Vector divide_by_128(Vector v) { return _mm256_mulhrs_epi16(v, fill16(256)); }
  HOLDFAST_TARGET_INLINE static Vector to_high_bytes(Vector v) { return _mm256_slli_epi16(v, 8); }
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return _mm256_packus_epi16(low, high); }
  /// Blocks of 16 bytes, and the 8 bytes that each becomes.
  static constexpr int blocks = 2;
  HOLDFAST_TARGET_INLINE static Vector load_blocks(const std::uint8_t* row, const int* begin) {
    return _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(row + begin[1]),
                               reinterpret_cast<const __m128i*>(row + begin[0]));
  }
  HOLDFAST_TARGET_INLINE static void store_blocks(std::uint8_t* p, Vector v) {
    const Vector packed = _mm256_permute4x64_epi64(_mm256_packus_epi16(v, v), 0x08);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_castsi256_si128(packed));
  }
  HOLDFAST_TARGET_INLINE static Vector shuffle(Vector v, Vector from) { return _mm256_shuffle_epi8(v, from); }
  HOLDFAST_TARGET_INLINE static Vector widen(Vector v) { return _mm256_madd_epi16(v, _mm256_set1_epi16(1)); }
  HOLDFAST_TARGET_INLINE static Vector add32(Vector a, Vector b) { return _mm256_add_epi32(a, b); }
  HOLDFAST_TARGET_INLINE static int sum32(Vector v) {
    __m128i half = _mm_add_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
    half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0x4e));
    half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0xb1));
    return _mm_cvtsi128_si32(half);
  }
};

#include "kernels_any_width.inl"
#include "kernels_vector.inl"

}  // namespace

const Kernels& avx2_kernels() {
  // Three rows of three pixels do not fill even a small vector, and a gather takes longer than inserting bytes one by
  // one.
  static const Kernels table = {fast_scores, sse4_kernels().neighbour_scores, local_maxima, resize, blur,
                                moments,     sse4_kernels().describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
