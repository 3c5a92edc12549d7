// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <vector>

namespace sensor_msgs::msg {
struct CameraInfo {
  using SharedPtr = std::shared_ptr<CameraInfo>;
  using ConstSharedPtr = std::shared_ptr<const CameraInfo>;

  std_msgs::msg::Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
};
}  // namespace sensor_msgs::msg
