// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace holdfast {

/// Sensor mode: the images of a frame that a pipeline uses, which determine the unit of the map.
enum class Sensor {
  rgbd,    ///< colour and depth; the map is in metres
  stereo,  ///< a rectified pair; the map is in metres
  mono,    ///< colour alone; the unit of the map is arbitrary (TrackingSettings::start_depth)
};

/// Properties of a sensor mode. Use these functions instead of comparisons with Sensor.
/// @{
/// Features have a measured depth, by a depth image or by the disparity of a pair.
constexpr bool features_have_depth(Sensor sensor) { return sensor != Sensor::mono; }
/// The unit of the map is the metre, and its scale does not drift.
constexpr bool scale_is_known(Sensor sensor) { return sensor != Sensor::mono; }
/// Frames have a depth image.
constexpr bool has_dense_depth(Sensor sensor) { return sensor == Sensor::rgbd; }
/// @}

/// rgbd, stereo or mono.
const char* sensor_name(Sensor sensor);
/// The sensor of that name, or nothing.
std::optional<Sensor> find_sensor(const std::string& name);
/// All names, in the order of Sensor.
const std::vector<std::string>& sensor_names();

}  // namespace holdfast
