// SPDX-License-Identifier: BSD-3-Clause
#include "subpixel.hpp"

#include <algorithm>

namespace holdfast::orb_plugin {

SubpixelOffset score_peak(const std::array<std::uint8_t, 9>& s) {
  // f(x, y) = f0 + gx x + gy y + hxx x^2 / 2 + hxy x y + hyy y^2 / 2, times 6, 6, 3, 4 and 3: integers.
  const int gradient_x = s[2] + s[5] + s[8] - s[0] - s[3] - s[6];
  const int gradient_y = s[6] + s[7] + s[8] - s[0] - s[1] - s[2];
  const int curvature_x = s[0] + s[3] + s[6] + s[2] + s[5] + s[8] - 2 * (s[1] + s[4] + s[7]);
  const int curvature_y = s[0] + s[1] + s[2] + s[6] + s[7] + s[8] - 2 * (s[3] + s[4] + s[5]);
  const int twist = s[0] + s[8] - s[2] - s[6];

  const float gx = static_cast<float>(gradient_x) / 6, gy = static_cast<float>(gradient_y) / 6;
  const float hxx = static_cast<float>(curvature_x) / 3, hyy = static_cast<float>(curvature_y) / 3;
  const float hxy = static_cast<float>(twist) / 4;
  const float determinant = hxx * hyy - hxy * hxy;
  if (hxx >= 0 || determinant <= 0) return {};
  constexpr float limit = 0.75F;
  return {std::clamp((hxy * gy - hyy * gx) / determinant, -limit, limit),
          std::clamp((hxy * gx - hxx * gy) / determinant, -limit, limit)};
}

}  // namespace holdfast::orb_plugin
