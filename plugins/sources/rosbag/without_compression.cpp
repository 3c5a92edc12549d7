// SPDX-License-Identifier: BSD-3-Clause
// The chunks of a build without lz4 and bzip2.
#include "chunk.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::rosbag_plugin {

std::vector<std::uint8_t> decompress_chunk(Bytes, const std::string& compression, std::size_t,
                                           const std::string& place) {
  throw InputError({place}, "is compressed by '" + compression +
                                "', but this build has no lz4 and bzip2 (Debian: liblz4-dev libbz2-dev)");
}

}  // namespace holdfast::rosbag_plugin
