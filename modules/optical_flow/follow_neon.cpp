// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#if defined(__aarch64__)
#include <arm_neon.h>

#include <cstring>

#define HOLDFAST_TARGET
#define HOLDFAST_TARGET_INLINE HOLDFAST_TARGET __attribute__((always_inline)) inline
#define HOLDFAST_FOLLOW follow_neon

namespace holdfast::point_flow {
namespace {

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  const uint16x8_t wide = vmovl_u8(vld1_u8(pixels));
  const float32x4_t halves[2] = {vcvtq_f32_u32(vmovl_u16(vget_low_u16(wide))), vcvtq_f32_u32(vmovl_high_u16(wide))};
  std::memcpy(&row, halves, sizeof(row));
}

}  // namespace
}  // namespace holdfast::point_flow

#include "follow_any_processor.inl"
#endif
