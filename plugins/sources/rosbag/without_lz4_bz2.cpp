// SPDX-License-Identifier: BSD-3-Clause
// The chunks of a build without lz4 and bzip2.
#include "chunk.hpp"

namespace holdfast::rosbag_plugin {

namespace {

[[noreturn]] void refuse_lz4_bz2(const char* compression, const std::string& place) {
  throw InputError({place}, std::string("is compressed by ") + compression +
                                ", but this build has no lz4 and bzip2 (Debian: liblz4-dev libbz2-dev)");
}

}  // namespace

std::vector<std::uint8_t> decompress_lz4(Bytes, std::size_t, const std::string& place) { refuse_lz4_bz2("lz4", place); }
std::vector<std::uint8_t> decompress_bz2(Bytes, std::size_t, const std::string& place) { refuse_lz4_bz2("bz2", place); }

}  // namespace holdfast::rosbag_plugin
