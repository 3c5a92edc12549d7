// SPDX-License-Identifier: BSD-3-Clause
// What zstd compressed, in a build without it.
#include "chunk.hpp"
#include "zstd_file.hpp"

namespace holdfast::rosbag_plugin {

namespace {

[[noreturn]] void refuse_zstd(const std::string& place) {
  throw InputError({place},
                   "is compressed by zstd, but zstd was not found when Holdfast was configured; install it (Debian: "
                   "libzstd-dev), configure and build again");
}

}  // namespace

std::vector<std::uint8_t> decompress_zstd(Bytes, std::size_t, const std::string& place) { refuse_zstd(place); }
std::filesystem::path unpack_to_temporary_file(const std::filesystem::path& file) { refuse_zstd(file.string()); }

}  // namespace holdfast::rosbag_plugin
