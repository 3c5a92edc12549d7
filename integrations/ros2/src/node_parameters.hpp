// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>

#include "holdfast/bridge/bridge.hpp"

namespace holdfast_ros {

/// Parameters of the node; README.md describes them.
struct NodeParameters {
  holdfast::bridge::Parameters bridge;
  std::string map_frame = "map", odom_frame = "odom", base_frame = "base_link";
  std::string camera_frame;  ///< empty = that of the colour images
  bool publishes_tf = true;
  bool has_external_odometry = false;  ///< `odom` to `base_link` comes by tf
  double transform_tolerance = 0.1;    ///< with external odometry: `map` to `odom` holds so long ahead [s]
  double transform_wait = 1.0;         ///< for the pose of the camera on the robot [s]
  bool is_compressed = false;
};

/// Declares the parameters with their defaults.
void declare_parameters(rclcpp_lifecycle::LifecycleNode& node);
/// Reads them. Throws std::runtime_error for an unknown name or a value that cannot be.
NodeParameters read_parameters(rclcpp_lifecycle::LifecycleNode& node);

}  // namespace holdfast_ros
