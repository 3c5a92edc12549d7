// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Chi-square test (95 %) of the reprojection error of a feature: two residuals (column and row), or three when the
/// feature has a column in the right image (Mur-Artal and Tardos 2017, section III). Columns and row are undistorted
/// pixels.
template <FeatureView View>
bool agrees_with_prediction(const View& view, std::uint32_t feature, double x, double y, double right_x) {
  using Traits = ViewTraits<View>;
  const double dx = x - Traits::x(view, feature), dy = y - Traits::y(view, feature);
  double error = dx * dx + dy * dy;
  double limit = geometry::chi_square_two;
  if (const float measured = Traits::right_x(view, feature); !std::isnan(measured)) {
    const double difference = measured - right_x;
    error += difference * difference;
    limit = geometry::chi_square_three;
  }
  return error * Traits::inverse_sigma2(view, Traits::octave(view, feature)) <= limit;
}

}  // namespace holdfast::matching
