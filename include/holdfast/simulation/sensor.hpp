// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::simulation {

/// Effects of a Kinect on depth. Each effect can be disabled by its value.
struct DepthSensorSettings {
  /// Factor on the standard deviation 0.0012 + 0.0019 (z - 0.4)^2 + 0.0001 / sqrt(z) a^2 / (pi/2 - a)^2 [m] with depth
  /// z [m] and angle of incidence a (Nguyen, Izadi and Lovell 2012, equations 4 and 5). The formula includes the
  /// contribution of quantisation. 0 = none.
  double noise = 1.0;
  /// Whether the disparity is rounded to 1/8 px, which is 2.9 mm z^2 of depth (Khoshelham and Elberink 2012).
  bool quantisation = true;
  /// Whether values are missing in the shadow of the pattern projector (left of near objects) and, increasingly, on
  /// surfaces at viewing angles below 12 degrees.
  bool holes = true;
  double minimum_depth = 0.4;  ///< smaller depths have no value [m]
  double maximum_depth = 8.0;  ///< larger depths have no value [m]
  /// Maximum width of the band without values on either side of a depth edge [px]. The width varies along the edge and
  /// with time, and its border is irregular. 0 = none.
  double edge_holes = 2.0;
  double dropout = 0.0;  ///< fraction of pixels that randomly have no value, 0 to 1

  static void describe(ParameterTable<DepthSensorSettings>& table);
};

/// Effects of the colour camera. Each effect can be disabled by its value.
struct ColourSensorSettings {
  double noise = 2.0;  ///< standard deviation per channel [grey levels]; 0 = none
  /// Variation of the exposure, 0 to 1: the gain oscillates between 1 / (1 + exposure_change) and 1 + exposure_change
  /// with a period of about exposure_period [s] and varying amplitude. 0 = constant.
  double exposure_change = 0.0;
  double exposure_period = 4.0;
  double vignetting = 0.0;  ///< fraction of light lost in the corners, 0 to 1; quadratic in the radius
  double shutter = 0.0;     ///< exposure time, which causes motion blur (applied by Simulator) [s]; 0 = sharp

  static void describe(ParameterTable<ColourSensorSettings>& table);
};

/// Applies the depth sensor model and returns the measured depth: 32FC1 [m], 0 = no value. `depth` and `cosine` are
/// those of RenderedFrame. The result depends on the arguments only, so that frames can be computed in any order.
/// `seed` is that of the sequence and `time` [s] that of the frame: noise is independent between frames, holes at edges
/// change slowly.
cv::Mat sense_depth(const cv::Mat& depth, const cv::Mat& cosine, const Camera& camera,
                    const DepthSensorSettings& settings, std::uint64_t seed, double time = 0.0);

/// Applies the colour camera model to a rendered image (8UC3) in place: the gain of the varying exposure, vignetting
/// and `gain` (the light of the scene, 1 = as rendered, 0 = dark), then independent noise in each channel, then
/// clipping to 0 to 255. `seed` and `time` as for sense_depth.
void sense_colour(cv::Mat& colour, const ColourSensorSettings& settings, std::uint64_t seed, double time = 0.0,
                  double gain = 1.0);

/// The gain of the varying exposure at a time [s].
double exposure_gain(const ColourSensorSettings& settings, std::uint64_t seed, double time);

}  // namespace holdfast::simulation
