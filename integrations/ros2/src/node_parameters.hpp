// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "holdfast/bridge/node_parameters.hpp"

namespace holdfast_ros {

using holdfast::bridge::NodeParameters;

/// Declares the parameters with their defaults.
void declare_parameters(rclcpp_lifecycle::LifecycleNode& node);
/// Reads them. Throws std::runtime_error for an unknown name or a value that cannot be.
NodeParameters read_parameters(rclcpp_lifecycle::LifecycleNode& node);

}  // namespace holdfast_ros
