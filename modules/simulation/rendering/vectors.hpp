// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

/// The compiler's vectors of sixteen bytes, which every processor has: the same instructions, and so the same bytes,
/// everywhere.
namespace holdfast::simulation {

using Floats4 = float __attribute__((vector_size(16)));
using Integers4 = std::int32_t __attribute__((vector_size(16)));
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

inline Floats4 smaller(Floats4 a, Floats4 b) { return a < b ? a : b; }
inline Floats4 larger(Floats4 a, Floats4 b) { return a > b ? a : b; }

}  // namespace holdfast::simulation
