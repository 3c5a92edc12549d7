// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/simulation/world.hpp"
#include "vectors.hpp"

namespace holdfast::simulation {

/// The shade on the floor below what stands on it or passes close above, so that things that move do not seem to float:
/// an ellipse around the lowest part of each of their bones.
struct ContactShadow {
  static constexpr float reach = 0.25F;  ///< things higher above the floor throw none [m]

  float x, y;                  ///< middle [m]
  float inverse_x, inverse_y;  ///< 1 / half axes [1/m]
  float depth;                 ///< share of light that is lost in the middle
};

/// Adds those of an object that moves.
void add_contact_shadows(const Object& object, const std::vector<PosedVertex>& posed,
                         std::vector<ContactShadow>& shadows);

/// The share of light that is left on the floor at four places.
inline Floats4 unshaded(const std::vector<ContactShadow>& shadows, Floats4 x, Floats4 y) {
  Floats4 left = {1.0F, 1.0F, 1.0F, 1.0F};
  const Floats4 none = {0.0F, 0.0F, 0.0F, 0.0F};
  for (const ContactShadow& shadow : shadows) {
    const Floats4 across = (x - shadow.x) * shadow.inverse_x, along = (y - shadow.y) * shadow.inverse_y;
    const Floats4 inside = larger(1.0F - (across * across + along * along), none);
    left *= 1.0F - shadow.depth * inside * inside;
  }
  return left;
}

}  // namespace holdfast::simulation
