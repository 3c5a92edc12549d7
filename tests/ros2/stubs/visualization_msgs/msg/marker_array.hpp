// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <geometry_msgs/msg/pose.hpp>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <vector>

namespace visualization_msgs::msg {
struct ColorRGBA {
  float r = 0, g = 0, b = 0, a = 0;
};
struct Marker {
  static constexpr std::int32_t CUBE = 1, TEXT_VIEW_FACING = 9, ADD = 0, DELETEALL = 3;
  std_msgs::msg::Header header;
  std::string ns;
  std::int32_t id = 0, type = 0, action = 0;
  geometry_msgs::msg::Pose pose;
  geometry_msgs::msg::Vector3 scale;
  ColorRGBA color;
  std::string text;
};
struct MarkerArray {
  std::vector<Marker> markers;
};
}  // namespace visualization_msgs::msg
