// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <cstring>

#define HOLDFAST_TARGET __attribute__((target("avx2")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline
#define HOLDFAST_FOLLOW follow_avx2

namespace holdfast::point_flow {
namespace {

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  const __m256 numbers =
      _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(pixels))));
  std::memcpy(&row, &numbers, sizeof(row));
}

}  // namespace
}  // namespace holdfast::point_flow

#include "follow_any_processor.inl"
#endif
