// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::simulation {

/// What a Kinect does to depth. Each effect can be switched off by its value.
struct DepthSensorSettings {
  /// Factor on the standard deviation 0.0012 + 0.0019 (z - 0.4)^2 + 0.0001 / sqrt(z) a^2 / (pi/2 - a)^2 [m] with depth
  /// z [m] and angle of incidence a (Nguyen, Izadi and Lovell 2012, equations 4 and 5). It is the total: what
  /// quantisation adds is not added again. 0 = none.
  double noise = 1.0;
  /// Round the disparity to eighths of a pixel, which is 2.9 mm z^2 of depth (Khoshelham and Elberink 2012).
  bool quantisation = true;
  /// No value in the shadow of the pattern projector (left of near things), at ragged depth edges, and, more and more,
  /// on surfaces seen flatter than 12 degrees.
  bool holes = true;
  double minimum_depth = 0.4;  ///< no value nearer [m]
  double maximum_depth = 8.0;  ///< no value farther [m]

  static void describe(ParameterTable<DepthSensorSettings>& table);
};

/// What the colour camera adds.
struct ColourSensorSettings {
  double noise = 2.0;  ///< standard deviation per channel [grey levels]; 0 = none

  static void describe(ParameterTable<ColourSensorSettings>& table);
};

/// The depth that the sensor reports: 32FC1 [m], 0 = no value. `depth` and `cosine` are those of RenderedFrame. The
/// result depends on the arguments alone; take a seed of its own for each frame.
cv::Mat sense_depth(const cv::Mat& depth, const cv::Mat& cosine, const Camera& camera,
                    const DepthSensorSettings& settings, std::uint64_t seed);

/// Adds noise to a colour image in place. Channels are independent.
void add_colour_noise(cv::Mat& colour, const ColourSensorSettings& settings, std::uint64_t seed);

}  // namespace holdfast::simulation
