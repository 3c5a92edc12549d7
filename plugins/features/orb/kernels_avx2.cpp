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
  using Vector = __m256i;
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
  HOLDFAST_TARGET_INLINE static std::uint32_t mask(Vector v) {
    return static_cast<std::uint32_t>(_mm256_movemask_epi8(v));
  }
  HOLDFAST_TARGET_INLINE static Vector fill16(int value) { return _mm256_set1_epi16(static_cast<short>(value)); }
  HOLDFAST_TARGET_INLINE static Vector fill_pairs(int first, int second) { return fill16(first | second << 8); }
  HOLDFAST_TARGET_INLINE static Vector interleave_low(Vector a, Vector b) { return _mm256_unpacklo_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector interleave_high(Vector a, Vector b) { return _mm256_unpackhi_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) { return _mm256_maddubs_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) { return _mm256_add_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector shift_right16(Vector v) { return _mm256_srli_epi16(v, 7); }
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return _mm256_packus_epi16(low, high); }
  HOLDFAST_TARGET_INLINE static Vector widen(Vector v) { return _mm256_madd_epi16(v, _mm256_set1_epi16(1)); }
  HOLDFAST_TARGET_INLINE static Vector add32(Vector a, Vector b) { return _mm256_add_epi32(a, b); }
  HOLDFAST_TARGET_INLINE static int sum32(Vector v) {
    __m128i half = _mm_add_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256(v, 1));
    half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0x4e));
    half = _mm_add_epi32(half, _mm_shuffle_epi32(half, 0xb1));
    return _mm_cvtsi128_si32(half);
  }
};

#include "kernels_vector.inl"

HOLDFAST_TARGET void describe(const std::uint8_t* centre, const std::int32_t* offsets, Descriptor256& descriptor) {
  const int* base = reinterpret_cast<const int*>(centre);
  const __m256i low_byte = _mm256_set1_epi32(0xff);
  for (int word = 0; word < 4; ++word) {
    std::uint64_t bits = 0;
    for (int group = 0; group < 64; group += 8) {
      const std::int32_t* pair = offsets + word * 64 + group;
      const __m256i a = _mm256_i32gather_epi32(base, Simd::load(pair), 1);
      const __m256i b = _mm256_i32gather_epi32(base, Simd::load(pair + 256), 1);
      const __m256i less = _mm256_cmpgt_epi32(_mm256_and_si256(b, low_byte), _mm256_and_si256(a, low_byte));
      bits |= static_cast<std::uint64_t>(_mm256_movemask_ps(_mm256_castsi256_ps(less))) << group;
    }
    descriptor.words[word] = bits;
  }
}

}  // namespace

const Kernels& avx2_kernels() {
  // Three pixels of a row do not fill even a small vector.
  static const Kernels table = {fast_scores, sse4_kernels().neighbour_scores, local_maxima, resize, blur, moments,
                                describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
