// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose.hpp>
#include <memory>
#include <std_msgs/msg/header.hpp>

namespace geometry_msgs::msg {
struct PoseStamped {
  using SharedPtr = std::shared_ptr<PoseStamped>;
  using ConstSharedPtr = std::shared_ptr<const PoseStamped>;

  std_msgs::msg::Header header;
  Pose pose;
};
}  // namespace geometry_msgs::msg
