// SPDX-License-Identifier: BSD-3-Clause
#include "kernels.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#define HOLDFAST_TARGET __attribute__((target("avx2,popcnt,avx512bw,avx512vl")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

namespace holdfast::orb_plugin {
namespace {

const Kernels& narrower_kernels() { return avx2_kernels(); }

/// Operations on 64 bytes. interleave_* and pack work within quarters of 16 bytes; one undoes the other.
struct Simd {
  using Vector = __m512i;
  using Bits = std::uint64_t;
  using Pairs = Vector;        ///< bytes of two vectors, alternating
  using PairWeights = Vector;  ///< two weights, alternating
  static constexpr int bytes = 64;
  HOLDFAST_TARGET_INLINE static Vector load(const void* p) { return _mm512_loadu_si512(p); }
  HOLDFAST_TARGET_INLINE static void store(void* p, Vector v) { _mm512_storeu_si512(p, v); }
  HOLDFAST_TARGET_INLINE static Vector fill(int value) { return _mm512_set1_epi8(static_cast<char>(value)); }
  HOLDFAST_TARGET_INLINE static Vector minimum(Vector a, Vector b) { return _mm512_min_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector maximum(Vector a, Vector b) { return _mm512_max_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector subtract(Vector a, Vector b) { return _mm512_subs_epu8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector bit_or(Vector a, Vector b) { return _mm512_or_si512(a, b); }
  HOLDFAST_TARGET_INLINE static Vector and_not(Vector a, Vector b) { return _mm512_andnot_si512(a, b); }
  HOLDFAST_TARGET_INLINE static Vector equal(Vector a, Vector b) {
    return _mm512_movm_epi8(_mm512_cmpeq_epi8_mask(a, b));
  }
  HOLDFAST_TARGET_INLINE static bool any(Vector v) { return _mm512_test_epi8_mask(v, v) != 0; }
  HOLDFAST_TARGET_INLINE static Bits mask(Vector v) { return _mm512_movepi8_mask(v); }
  HOLDFAST_TARGET_INLINE static Vector fill16(int value) { return _mm512_set1_epi16(static_cast<short>(value)); }
  HOLDFAST_TARGET_INLINE static Vector fill_pairs(int first, int second) { return fill16(first | second << 8); }
  HOLDFAST_TARGET_INLINE static Vector interleave_low(Vector a, Vector b) { return _mm512_unpacklo_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector interleave_high(Vector a, Vector b) { return _mm512_unpackhi_epi8(a, b); }
  HOLDFAST_TARGET_INLINE static Vector multiply_pairs(Vector a, Vector b) { return _mm512_maddubs_epi16(a, b); }
  HOLDFAST_TARGET_INLINE static Vector add16(Vector a, Vector b) { return _mm512_add_epi16(a, b); }
  /// Rounded: (v + 64) / 128.
  HOLDFAST_TARGET_INLINE static Vector divide_by_128(Vector v) { return _mm512_mulhrs_epi16(v, fill16(256)); }
  HOLDFAST_TARGET_INLINE static Vector to_high_bytes(Vector v) { return _mm512_slli_epi16(v, 8); }
  HOLDFAST_TARGET_INLINE static Vector pack(Vector low, Vector high) { return _mm512_packus_epi16(low, high); }
};

#include "kernels_any_width.inl"

}  // namespace

const Kernels& avx512_kernels() {
  // A row of a patch fills 32 bytes, and the tables of a reduction are made for vectors of that size.
  static const Kernels table = {
      fast_scores, sse4_kernels().neighbour_scores, local_maxima,           avx2_kernels().resize,
      blur,        avx2_kernels().moments,          sse4_kernels().describe};
  return table;
}

}  // namespace holdfast::orb_plugin
#endif
