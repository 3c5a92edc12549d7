// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Whether a feature lies where a point projects, by the chi-square test at 95 %: two residuals, or three when the
/// feature has depth (Mur-Artal and Tardos 2017, section III). `right_x` is the point's column in the virtual right
/// image.
inline bool reprojects_onto(const Frame& frame, std::uint32_t feature, const Eigen::Vector2d& pixel, double right_x) {
  constexpr double chi_square_two = 5.991, chi_square_three = 7.815;
  double error = (pixel - Eigen::Vector2d(frame.x[feature], frame.y[feature])).squaredNorm();
  double limit = chi_square_two;
  if (frame.has_depth(feature)) {
    const double difference = frame.right_x[feature] - right_x;
    error += difference * difference;
    limit = chi_square_three;
  }
  return error * frame.pyramid->inverse_sigma2[frame.features.octave[feature]] <= limit;
}

}  // namespace holdfast
