// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rclcpp/rclcpp.hpp>
#include <type_traits>

/// The class must be constructible from options alone.
#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass) \
  static_assert(std::is_constructible_v<NodeClass, const rclcpp::NodeOptions&>);
