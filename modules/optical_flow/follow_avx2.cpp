// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstring>

#define HOLDFAST_TARGET __attribute__((target("avx2")))
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline

namespace holdfast::point_flow {
namespace {

#include "follow_any_processor.inl"

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  const __m256 numbers =
      _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(pixels))));
  std::memcpy(&row, &numbers, sizeof(row));
}

}  // namespace

HOLDFAST_TARGET void follow_avx2(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings,
                                 PointFlow& flow) {
  follow_all(from, to, settings, flow);
}

}  // namespace holdfast::point_flow
#endif
