// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <geometry_msgs/msg/pose.hpp>

namespace tf2 {
geometry_msgs::msg::Pose toMsg(const Eigen::Affine3d& in);
geometry_msgs::msg::Pose toMsg(const Eigen::Isometry3d& in);
}  // namespace tf2
