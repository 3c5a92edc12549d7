// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose.hpp>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>

namespace nav_msgs::msg {
struct Odometry {
  using SharedPtr = std::shared_ptr<Odometry>;
  using ConstSharedPtr = std::shared_ptr<const Odometry>;

  std_msgs::msg::Header header;
  std::string child_frame_id;
  geometry_msgs::msg::PoseWithCovariance pose;
  geometry_msgs::msg::TwistWithCovariance twist;
};
}  // namespace nav_msgs::msg
