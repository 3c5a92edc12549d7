// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#define HOLDFAST_TARGET
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline
#define HOLDFAST_FOLLOW follow_scalar

namespace holdfast::point_flow {
namespace {

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  for (int i = 0; i < window; ++i) row[i] = static_cast<float>(pixels[i]);
}

}  // namespace
}  // namespace holdfast::point_flow

#include "follow_any_processor.inl"
