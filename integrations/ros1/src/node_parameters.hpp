// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "holdfast/bridge/node_parameters.hpp"

namespace holdfast_ros {

using holdfast::bridge::NodeParameters;

/// Reads the private parameters; those that are not set keep their defaults. Throws std::runtime_error for an unknown
/// name, a value of the wrong type, and one that cannot be.
NodeParameters read_parameters(const ros::NodeHandle& node);

/// `map_file` as it is set now, for services.
std::string map_file_of(const ros::NodeHandle& node);

}  // namespace holdfast_ros
