// SPDX-License-Identifier: BSD-3-Clause
#include "chunk.hpp"

#include <algorithm>

namespace holdfast::rosbag_plugin {

void make_room(std::vector<std::uint8_t>& bytes, std::size_t used, std::size_t size) {
  constexpr std::size_t step = std::size_t{1} << 20;
  if (used == bytes.size()) bytes.resize(std::min(size, std::max(2 * bytes.size(), step)));
}

std::vector<std::uint8_t> decompress_chunk(std::span<const Compression> known, const std::string& compression,
                                           Bytes compressed, std::size_t size, const std::string& place) {
  std::string names;
  for (const Compression& candidate : known) {
    names += std::string(", ") + candidate.name;
    if (compression != candidate.name) continue;
    std::vector<std::uint8_t> bytes = candidate.decompress(compressed, size, place);
    if (bytes.size() != size)
      throw InputError({place}, "has " + std::to_string(bytes.size()) + " bytes where it says " + std::to_string(size) +
                                    "; the bag is damaged, copy it again");
    return bytes;
  }
  throw InputError({place}, "is compressed by '" + compression + "'; expected none" + names);
}

}  // namespace holdfast::rosbag_plugin
