// SPDX-License-Identifier: BSD-3-Clause
#include "follow.hpp"

#include <array>
#include <cmath>

#define HOLDFAST_TARGET
#define HOLDFAST_TARGET_INLINE __attribute__((always_inline)) inline

namespace holdfast::point_flow {
namespace {

#include "follow_any_processor.inl"

HOLDFAST_TARGET_INLINE void load(const std::uint8_t* pixels, Row& row) {
  for (int i = 0; i < window; ++i) row[i] = static_cast<float>(pixels[i]);
}

}  // namespace

HOLDFAST_TARGET void follow_scalar(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings,
                                   PointFlow& flow) {
  follow_all(from, to, settings, flow);
}

}  // namespace holdfast::point_flow
