// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

/// The compiler's vectors of sixteen bytes, which every processor has: the same instructions, and so the same bytes,
/// everywhere.
namespace holdfast::simulation {

using Floats4 = float __attribute__((vector_size(16)));
using Integers4 = std::int32_t __attribute__((vector_size(16)));
using Words4 = std::uint32_t __attribute__((vector_size(16)));
using Lanes8 = std::uint16_t __attribute__((vector_size(16)));

template <class Vector>
inline Vector load(const void* from) {
  Vector vector;
  std::memcpy(&vector, from, sizeof(vector));
  return vector;
}
template <class Vector>
inline void store(void* to, Vector vector) {
  std::memcpy(to, &vector, sizeof(vector));
}

// Where the compiler does not find the single instruction for an operation, it is named; the result is the same.
#ifdef __SSE2__
inline Floats4 smaller(Floats4 a, Floats4 b) { return _mm_min_ps(a, b); }
inline Floats4 larger(Floats4 a, Floats4 b) { return _mm_max_ps(a, b); }
inline Floats4 square_root(Floats4 a) { return _mm_sqrt_ps(a); }
/// a * b for 0 <= a, b < 32768.
inline Integers4 product_of_shorts(Integers4 a, Integers4 b) {
  return reinterpret_cast<Integers4>(_mm_madd_epi16(reinterpret_cast<__m128i>(a), reinterpret_cast<__m128i>(b)));
}
#else
inline Floats4 smaller(Floats4 a, Floats4 b) { return a < b ? a : b; }
inline Floats4 larger(Floats4 a, Floats4 b) { return a > b ? a : b; }
inline Floats4 square_root(Floats4 a) {
  Floats4 roots;
  for (int i = 0; i < 4; ++i) roots[i] = std::sqrt(a[i]);
  return roots;
}
inline Integers4 product_of_shorts(Integers4 a, Integers4 b) { return a * b; }
#endif

}  // namespace holdfast::simulation
