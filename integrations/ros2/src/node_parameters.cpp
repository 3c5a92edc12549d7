// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.hpp"

#include <algorithm>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <vector>

namespace holdfast_ros {

namespace {

/// Calls `use(name, value)` for every parameter; the grid and the start are no fields of their own.
template <class Use>
void visit(NodeParameters& p, bool& has_grid, std::string& start, const Use& use) {
  use("configuration", p.bridge.configuration);
  use("set", p.bridge.overrides);
  use("depth", p.bridge.has_depth);
  use("stereo", p.bridge.has_right);
  use("rectified", p.bridge.is_rectified);
  use("compressed", p.is_compressed);
  use("grid", has_grid);
  use("tolerance", p.bridge.tolerance);
  use("depth_factor", p.bridge.depth_factor);
  use("queue", p.bridge.queue);
  use("map_interval", p.bridge.map_interval);
  use("grid_interval", p.bridge.grid_interval);
  use("map_file", p.bridge.map_file);
  use("start", start);
  use("map_frame", p.map_frame);
  use("odom_frame", p.odom_frame);
  use("base_frame", p.base_frame);
  use("camera_frame", p.camera_frame);
  use("publish_tf", p.publishes_tf);
  use("external_odometry", p.has_external_odometry);
  use("transform_tolerance", p.transform_tolerance);
  use("transform_wait", p.transform_wait);
}

void refuse_unknown(rclcpp_lifecycle::LifecycleNode& node) {
  for (const auto& given : node.get_node_parameters_interface()->get_parameter_overrides())
    if (!node.has_parameter(given.first) && given.first.rfind("qos_overrides.", 0) != 0)
      throw std::runtime_error("there is no parameter '" + given.first +
                               "'; README.md of integrations/ros2 lists all; those of the pipeline are set by `set`, "
                               "such as set: [tracking.minimum_inliers=15]");
}

}  // namespace

void declare_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  NodeParameters defaults;
  bool has_grid = true;
  std::string start = "new";
  visit(defaults, has_grid, start, [&](const char* name, auto& value) { value = node.declare_parameter(name, value); });
}

NodeParameters read_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  NodeParameters p;
  bool has_grid = true;
  std::string start = "new";
  visit(p, has_grid, start, [&](const char* name, auto& value) { node.get_parameter(name, value); });
  refuse_unknown(node);
  // ROS 2 has no empty list of strings in launch files.
  auto& overrides = p.bridge.overrides;
  overrides.erase(std::remove(overrides.begin(), overrides.end(), std::string()), overrides.end());
  if (has_grid) p.bridge.overrides.insert(p.bridge.overrides.begin(), "surface.enabled=true");
  if (p.bridge.configuration.empty())
    throw std::runtime_error("parameter 'configuration' is missing; expected the YAML file of a pipeline");
  if (start != "new" && start != "continue" && start != "localise")
    throw std::runtime_error("found '" + start + "' for 'start'; expected new, continue or localise");
  if (start != "new" && p.bridge.map_file.empty())
    throw std::runtime_error("'start' is '" + start + "' without 'map_file'; expected the file of a map");
  p.bridge.localise_only = start == "localise";
  if (start == "new") p.bridge.map_file.clear();
  return p;
}

}  // namespace holdfast_ros
