// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#if defined(__x86_64__)
#include <smmintrin.h>

#include <cstring>

#define HOLDFAST_TARGET __attribute__((target("sse4.1")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline
#define HOLDFAST_FOLLOW follow_sse4

namespace holdfast::point_flow {
namespace {

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(pixels));
  const __m128 halves[2] = {_mm_cvtepi32_ps(_mm_cvtepu8_epi32(bytes)),
                            _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_srli_si128(bytes, 4)))};
  std::memcpy(&row, halves, sizeof(row));
}

}  // namespace
}  // namespace holdfast::point_flow

#include "follow_any_processor.inl"
#endif
