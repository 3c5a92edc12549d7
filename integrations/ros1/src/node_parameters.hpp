// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "holdfast/bridge/bridge.hpp"

namespace holdfast_ros {

/// Private parameters of the node; README.md describes them.
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

/// Reads the parameters; those that are not set keep their defaults. Throws std::runtime_error for an unknown name or a
/// value of the wrong type.
NodeParameters read_parameters(const ros::NodeHandle& node);

/// `map_file` as it is set now, for services.
std::string map_file_of(const ros::NodeHandle& node);

}  // namespace holdfast_ros
