// SPDX-License-Identifier: BSD-3-Clause
#include "orientation.hpp"

#include <cstdlib>
#include <numbers>
#include <utility>

namespace holdfast::orb_plugin {

float direction(int x, int y) {
  if (x == 0 && y == 0) return 0.0F;
  double along = std::abs(static_cast<double>(x)), across = std::abs(static_cast<double>(y));
  const bool is_steep = across > along;
  if (is_steep) std::swap(along, across);
  // Abramowitz and Stegun 1964, 4.4.49.
  const double t = across / along, t2 = t * t;
  double angle = 0.0028662257;
  for (const double coefficient :
       {-0.0161657367, 0.0429096138, -0.0752896400, 0.1065626393, -0.1420889944, 0.1999355085, -0.3333314528, 1.0})
    angle = angle * t2 + coefficient;
  angle *= t;
  if (is_steep) angle = std::numbers::pi / 2 - angle;
  if (x < 0) angle = std::numbers::pi - angle;
  if (y < 0) angle = 2 * std::numbers::pi - angle;
  const auto result = static_cast<float>(angle);
  return result < 2 * std::numbers::pi_v<float> ? result : 0.0F;
}

}  // namespace holdfast::orb_plugin
