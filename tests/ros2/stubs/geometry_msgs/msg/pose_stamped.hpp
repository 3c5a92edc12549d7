// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose.hpp>
#include <std_msgs/msg/header.hpp>

namespace geometry_msgs::msg {
struct PoseStamped {
  std_msgs::msg::Header header;
  Pose pose;
};
}  // namespace geometry_msgs::msg
