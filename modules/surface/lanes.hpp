// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

#define HOLDFAST_INLINE __attribute__((always_inline)) static inline

#if defined(__GNUC__) && !defined(__clang__)
// Functions that return eight numbers are always inlined, so that none is called with another set of instructions.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace holdfast::surface {

/// Eight numbers at once, on which the compiler works with the instructions of the function into which a kernel is
/// inlined.
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

HOLDFAST_INLINE Float8 load8(const float* from) {
  Float8 lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

HOLDFAST_INLINE bool any_of(const Int8& lanes) {
  std::int64_t any[4];
  std::memcpy(any, &lanes, sizeof(any));
  return (any[0] | any[1] | any[2] | any[3]) != 0;
}

}  // namespace holdfast::surface
