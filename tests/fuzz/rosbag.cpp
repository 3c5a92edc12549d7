// SPDX-License-Identifier: BSD-3-Clause
// Recordings of ROS in every container, and the messages in them.
#include "bag_messages.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("recording.bag", {data, size});
  fuzz::accepts([&] { fuzz::read_bag(*rosbag_plugin::open_bag(file)); });
  return 0;
}
