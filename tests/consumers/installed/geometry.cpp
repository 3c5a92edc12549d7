// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/se3.hpp"
#include "holdfast/geometry/warp.hpp"

int main() {
  namespace geometry = holdfast::geometry;
  geometry::Vector6d tangent;
  tangent << 0.1, 0.2, -0.3, 0.05, -0.04, 0.03;
  const geometry::Warp warp(geometry::exp_se3(tangent), {525.0, 525.0, 319.5, 239.5, 0.0});
  return warp(0.0F, 0.0F, 2.0F) ? 0 : 1;
}
