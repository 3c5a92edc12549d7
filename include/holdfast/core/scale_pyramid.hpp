// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "holdfast/core/check.hpp"

namespace holdfast {

/// The scale pyramid of feature extraction: level 0 is the full image, and level i is smaller by factor^i. The standard
/// deviation of a feature's position is sigma = factor^i [px of the full image].
struct ScalePyramid {
  ScalePyramid() : ScalePyramid(8, 1.2) {}
  ScalePyramid(int levels, double factor);

  int levels() const { return static_cast<int>(scale.size()); }
  /// The level at which a map point is expected: ceil(log(maximum_distance / distance) / log(factor)), clamped to the
  /// pyramid (Mur-Artal et al. 2015, section V-D). `maximum_distance` is that of the point, `distance` its distance
  /// from the camera, both in metres.
  int predict_level(double maximum_distance, double distance) const;

  double factor = 1.2;
  double log_factor = 0.0;
  std::vector<float> scale;           ///< factor^level
  std::vector<float> inverse_scale;   ///< factor^-level
  std::vector<float> sigma2;          ///< scale^2 [px^2]
  std::vector<float> inverse_sigma2;  ///< scale^-2 [1/px^2]
};

inline ScalePyramid::ScalePyramid(int levels, double factor_between_levels)
    : factor(factor_between_levels), log_factor(std::log(factor_between_levels)) {
  HOLDFAST_CHECK(levels >= 1 && factor > 1.0, "levels " << levels << " factor " << factor);
  double level_scale = 1.0;
  for (int level = 0; level < levels; ++level, level_scale *= factor) {
    scale.push_back(static_cast<float>(level_scale));
    inverse_scale.push_back(static_cast<float>(1.0 / level_scale));
    sigma2.push_back(static_cast<float>(level_scale * level_scale));
    inverse_sigma2.push_back(static_cast<float>(1.0 / (level_scale * level_scale)));
  }
}

inline int ScalePyramid::predict_level(double maximum_distance, double distance) const {
  const int level = static_cast<int>(std::ceil(std::log(maximum_distance / distance) / log_factor));
  return std::clamp(level, 0, levels() - 1);
}

}  // namespace holdfast
