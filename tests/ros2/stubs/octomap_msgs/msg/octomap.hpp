// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <std_msgs/msg/header.hpp>
#include <string>
#include <vector>

namespace octomap_msgs::msg {
struct Octomap {
  using SharedPtr = std::shared_ptr<Octomap>;
  using ConstSharedPtr = std::shared_ptr<const Octomap>;

  std_msgs::msg::Header header;
  bool binary = false;
  std::string id;
  double resolution = 0;
  std::vector<std::int8_t> data;
};
}  // namespace octomap_msgs::msg
