// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <vector>

namespace sensor_msgs::msg {
struct CompressedImage {
  using SharedPtr = std::shared_ptr<CompressedImage>;
  using ConstSharedPtr = std::shared_ptr<const CompressedImage>;

  std_msgs::msg::Header header;
  std::string format;
  std::vector<std::uint8_t> data;
};
}  // namespace sensor_msgs::msg
