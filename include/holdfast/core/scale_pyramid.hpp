// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace holdfast {

/// The scales at which features are found: level 0 is the full image, level i is smaller by factor^i. The position
/// noise of a feature grows with its level: sigma = factor^i pixels of the full image.
struct ScalePyramid {
  ScalePyramid() : ScalePyramid(8, 1.2) {}
  ScalePyramid(int levels, double factor);

  int levels() const { return static_cast<int>(scale.size()); }
  /// The level at which a point of size distance/minimum_distance ratio is expected, clamped to the pyramid
  /// (Mur-Artal et al. 2015, section V-D): ceil(log(maximum_distance / distance) / log(factor)).
  int predict_level(double maximum_distance, double distance) const;

  double factor = 1.2;
  double log_factor = 0.0;
  std::vector<float> scale;           ///< factor^level
  std::vector<float> inverse_scale;   ///< factor^-level
  std::vector<float> sigma2;          ///< scale^2 [px^2]
  std::vector<float> inverse_sigma2;  ///< scale^-2 [1/px^2]
};

}  // namespace holdfast
