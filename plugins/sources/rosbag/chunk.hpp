// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "byte_reader.hpp"

namespace holdfast::rosbag_plugin {

/// Most bytes that a chunk may take when it is decompressed; those of `rosbag record` take some megabytes.
constexpr std::size_t largest_chunk = std::size_t{1} << 27;

/// The content of a chunk of `size` bytes that is compressed by "lz4" (LZ4 frame format) or "bz2". Memory grows with
/// what comes out, so that a false size takes none. Throws InputError at `place` for damaged data, for another size and
/// for another compression.
std::vector<std::uint8_t> decompress_chunk(Bytes compressed, const std::string& compression, std::size_t size,
                                           const std::string& place);

}  // namespace holdfast::rosbag_plugin
