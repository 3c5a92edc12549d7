// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/sensor.hpp"

namespace holdfast {

const std::vector<std::string>& sensor_names() {
  static const std::vector<std::string> names = {"rgbd", "stereo", "mono"};
  return names;
}

const char* sensor_name(Sensor sensor) { return sensor_names()[static_cast<std::size_t>(sensor)].c_str(); }

std::optional<Sensor> find_sensor(const std::string& name) {
  for (const Sensor sensor : {Sensor::rgbd, Sensor::stereo, Sensor::mono})
    if (name == sensor_name(sensor)) return sensor;
  return std::nullopt;
}

}  // namespace holdfast
