// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/msg/pose.hpp>
#include <memory>
#include <std_msgs/msg/header.hpp>

namespace geometry_msgs::msg {
struct PoseWithCovarianceStamped {
  using SharedPtr = std::shared_ptr<PoseWithCovarianceStamped>;
  using ConstSharedPtr = std::shared_ptr<const PoseWithCovarianceStamped>;

  std_msgs::msg::Header header;
  PoseWithCovariance pose;
};
}  // namespace geometry_msgs::msg
