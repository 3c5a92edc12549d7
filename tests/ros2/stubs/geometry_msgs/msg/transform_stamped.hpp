// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose.hpp>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>

namespace geometry_msgs::msg {
struct TransformStamped {
  using SharedPtr = std::shared_ptr<TransformStamped>;
  using ConstSharedPtr = std::shared_ptr<const TransformStamped>;

  std_msgs::msg::Header header;
  std::string child_frame_id;
  Transform transform;
};
}  // namespace geometry_msgs::msg
