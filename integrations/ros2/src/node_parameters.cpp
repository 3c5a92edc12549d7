// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.hpp"

#include <algorithm>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>

namespace holdfast_ros {

namespace {

void refuse_unknown(rclcpp_lifecycle::LifecycleNode& node) {
  for (const auto& given : node.get_node_parameters_interface()->get_parameter_overrides())
    if (!node.has_parameter(given.first) && given.first.rfind("qos_overrides.", 0) != 0)
      throw holdfast::bridge::unknown_parameter(given.first, "ros2");
}

}  // namespace

void declare_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  NodeParameters defaults;
  holdfast::bridge::visit_parameters(
      defaults, [&](const char* name, auto& value) { value = node.declare_parameter(name, value); });
}

NodeParameters read_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  NodeParameters parameters;
  holdfast::bridge::visit_parameters(parameters,
                                     [&](const char* name, auto& value) { node.get_parameter(name, value); });
  refuse_unknown(node);
  // ROS 2 has no empty list of strings in launch files.
  auto& overrides = parameters.bridge.overrides;
  overrides.erase(std::remove(overrides.begin(), overrides.end(), std::string()), overrides.end());
  return holdfast::bridge::resolved(std::move(parameters));
}

}  // namespace holdfast_ros
