// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS 2. The first byte chooses the type.
#include "bag_messages.hpp"

using namespace holdfast;
using namespace holdfast::rosbag_plugin;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* types[] = {image_type, compressed_image_type, camera_info_type};
  const Bytes bytes(data + 1, size - 1);
  fuzz::read_message({bytes, types[data[0] % 3], &cdr_encoding(), "message"});
  return 0;
}
