// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast::geometry {

/// What a feature of a frame says in a bundle problem: the frame is pose number `pose`, and the feature shows point
/// number `point`. Weighted by the probability that the feature belongs to the static world.
inline BundleProblem::Observation bundle_observation(const Frame& frame, std::uint32_t feature, std::uint32_t pose,
                                                     std::uint32_t point) {
  return {.pose = pose,
          .point = point,
          .x = frame.x[feature],
          .y = frame.y[feature],
          .right_x = frame.right_x[feature],
          .inverse_sigma2 = frame.pyramid->inverse_sigma2[frame.features.octave[feature]],
          .weight = frame.static_probability[feature]};
}

}  // namespace holdfast::geometry
