// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Overridden by the test, which parses the node for an older and a newer release.
#ifndef RCLCPP_VERSION_MAJOR
#define RCLCPP_VERSION_MAJOR 28
#endif
#define RCLCPP_VERSION_MINOR 0
#define RCLCPP_VERSION_PATCH 0
#define RCLCPP_VERSION_GTE(major, minor, patch) \
  ((major) < RCLCPP_VERSION_MAJOR ||            \
   ((major) == RCLCPP_VERSION_MAJOR &&          \
    ((minor) < RCLCPP_VERSION_MINOR || ((minor) == RCLCPP_VERSION_MINOR && (patch) <= RCLCPP_VERSION_PATCH))))
