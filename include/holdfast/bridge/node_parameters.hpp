// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "holdfast/bridge/bridge.hpp"

namespace holdfast::bridge {

/// Parameters of a node of ROS; integrations/ros1/README.md describes them. C++17, as the headers of the bridge.
struct NodeParameters {
  Parameters bridge;
  std::string start = "new";  ///< or continue, localise
  bool has_grid = true;       ///< surface.enabled=true is added to the overrides
  std::string map_frame = "map", odom_frame = "odom", base_frame = "base_link";
  std::string camera_frame;  ///< empty = that of the colour images
  bool publishes_tf = true;
  bool has_external_odometry = false;  ///< `odom` to `base_link` comes by tf
  double transform_tolerance = 0.1;    ///< with external odometry: `map` to `odom` holds so long ahead [s]
  double transform_wait = 1.0;         ///< for the pose of the camera on the robot [s]
  bool is_compressed = false;
};

/// Calls `use(name, value)` for every parameter: the one list of their names.
template <class Use>
void visit_parameters(NodeParameters& p, const Use& use) {
  use("configuration", p.bridge.configuration);
  use("set", p.bridge.overrides);
  use("depth", p.bridge.has_depth);
  use("stereo", p.bridge.has_right);
  use("rectified", p.bridge.is_rectified);
  use("compressed", p.is_compressed);
  use("grid", p.has_grid);
  use("tolerance", p.bridge.tolerance);
  use("depth_factor", p.bridge.depth_factor);
  use("queue", p.bridge.queue);
  use("map_interval", p.bridge.map_interval);
  use("grid_interval", p.bridge.grid_interval);
  use("map_file", p.bridge.map_file);
  use("start", p.start);
  use("map_frame", p.map_frame);
  use("odom_frame", p.odom_frame);
  use("base_frame", p.base_frame);
  use("camera_frame", p.camera_frame);
  use("publish_tf", p.publishes_tf);
  use("external_odometry", p.has_external_odometry);
  use("transform_tolerance", p.transform_tolerance);
  use("transform_wait", p.transform_wait);
}

/// The error of a parameter that a node does not have. `node`: such as "ros1".
inline std::runtime_error unknown_parameter(const std::string& name, const std::string& node) {
  return std::runtime_error("there is no parameter '" + name + "'; README.md of integrations/" + node +
                            " lists all; those of the pipeline are set by `set`, such as set: "
                            "[tracking.minimum_inliers=15]");
}

/// Parameters as they were given, made those of the bridge. Throws std::runtime_error for values that cannot be, alone
/// or together; the bridge checks its own.
inline NodeParameters resolved(NodeParameters p) {
  if (p.bridge.configuration.empty())
    throw std::runtime_error("parameter 'configuration' is missing; expected the YAML file of a pipeline");
  if (p.start != "new" && p.start != "continue" && p.start != "localise")
    throw std::runtime_error("found '" + p.start + "' for 'start'; expected new, continue or localise");
  if (p.start != "new" && p.bridge.map_file.empty())
    throw std::runtime_error("'start' is '" + p.start + "' without 'map_file'; expected the file of a map");
  for (const auto& [name, value] :
       {std::pair("transform_tolerance", p.transform_tolerance), std::pair("transform_wait", p.transform_wait)})
    if (!(value >= 0.0 && value <= 1e6))
      throw std::runtime_error("found " + std::to_string(value) + " for '" + name + "'; expected 0 to 1e6 s");
  if (p.has_grid) p.bridge.overrides.insert(p.bridge.overrides.begin(), "surface.enabled=true");
  p.bridge.localise_only = p.start == "localise";
  if (p.start == "new") p.bridge.map_file.clear();
  return p;
}

}  // namespace holdfast::bridge
