// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/scale_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/error.hpp"

namespace holdfast {

ScalePyramid::ScalePyramid(int levels, double factor_between_levels)
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

int ScalePyramid::predict_level(double maximum_distance, double distance) const {
  const int level = static_cast<int>(std::ceil(std::log(maximum_distance / distance) / log_factor));
  return std::clamp(level, 0, levels() - 1);
}

}  // namespace holdfast
