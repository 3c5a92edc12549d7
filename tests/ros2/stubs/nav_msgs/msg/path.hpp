// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <memory>
#include <vector>

namespace nav_msgs::msg {
struct Path {
  using SharedPtr = std::shared_ptr<Path>;
  using ConstSharedPtr = std::shared_ptr<const Path>;

  std_msgs::msg::Header header;
  std::vector<geometry_msgs::msg::PoseStamped> poses;
};
}  // namespace nav_msgs::msg
