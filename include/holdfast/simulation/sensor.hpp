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
  /// No value in the shadow of the pattern projector (left of near things), and, more and more, on surfaces seen
  /// flatter than 12 degrees.
  bool holes = true;
  double minimum_depth = 0.4;  ///< no value nearer [m]
  double maximum_depth = 8.0;  ///< no value farther [m]
  /// Width of the band without values on either side of a depth edge where it is broadest [px]. The width varies along
  /// the edge and rolls on with time, and its border is ragged. 0 = none.
  double edge_holes = 2.0;
  double dropout = 0.0;  ///< share of pixels that have no value by chance, 0 to 1

  static void describe(ParameterTable<DepthSensorSettings>& table);
};

/// What the colour camera adds. Each effect can be switched off by its value.
struct ColourSensorSettings {
  double noise = 2.0;  ///< standard deviation per channel [grey levels]; 0 = none
  /// How far the exposure wanders, 0 to 1: the gain lies between 1 / (1 + exposure_change) and 1 + exposure_change and
  /// swings with about exposure_period [s], each swing of another size. 0 = constant.
  double exposure_change = 0.0;
  double exposure_period = 4.0;
  double vignetting = 0.0;  ///< share of light lost in the corners, 0 to 1; grows with the square of the radius
  double shutter = 0.0;     ///< how long it is open, which blurs what moves [s]; 0 = sharp. Simulator sees to it

  static void describe(ParameterTable<ColourSensorSettings>& table);
};

/// The depth that the sensor reports: 32FC1 [m], 0 = no value. `depth` and `cosine` are those of RenderedFrame. The
/// result depends on the arguments alone, so frames can be asked for in any order. `seed` is that of the sequence and
/// `time` [s] that of the frame: noise is independent between times, holes at edges roll on slowly.
cv::Mat sense_depth(const cv::Mat& depth, const cv::Mat& cosine, const Camera& camera,
                    const DepthSensorSettings& settings, std::uint64_t seed, double time = 0.0);

/// Turns a rendered colour image (8UC3) into that of the camera, in place: the gain of wandering exposure, vignetting
/// and `gain` (the light of the scene, 1 = as rendered, 0 = dark), then noise, independent in each channel, then
/// clipping to 0 to 255. `seed` and `time` as for sense_depth.
void sense_colour(cv::Mat& colour, const ColourSensorSettings& settings, std::uint64_t seed, double time = 0.0,
                  double gain = 1.0);

/// The gain of the wandering exposure at a time [s].
double exposure_gain(const ColourSensorSettings& settings, std::uint64_t seed, double time);

}  // namespace holdfast::simulation
