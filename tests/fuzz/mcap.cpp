// SPDX-License-Identifier: BSD-3-Clause
// MCAP files, and the messages in them. Damage is found by the checksums of chunks before anything else, so that most
// inputs of the corpus have none.
#include <vector>

#include "bag_messages.hpp"
#include "mcap_file.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("recording.mcap", {data, size});
  fuzz::accepts([&] {
    rosbag_plugin::McapFile bag(file, file);
    fuzz::read_bag(bag);
  });
  return 0;
}
