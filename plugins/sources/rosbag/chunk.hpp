// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "byte_reader.hpp"

namespace holdfast::rosbag_plugin {

/// Most bytes that a chunk or a message may take when it is decompressed; chunks of recorders take some megabytes.
constexpr std::size_t largest_chunk = std::size_t{1} << 27;

/// Decompresses data of `size` bytes, and stops soon after as many. Memory grows with what comes out, so that a false
/// size takes none. Throws InputError at `place` for damaged data, and in a build without the library.
using Decompress = std::vector<std::uint8_t> (*)(Bytes compressed, std::size_t size, const std::string& place);
std::vector<std::uint8_t> decompress_lz4(Bytes compressed, std::size_t size, const std::string& place);  // frame format
std::vector<std::uint8_t> decompress_bz2(Bytes compressed, std::size_t size, const std::string& place);
std::vector<std::uint8_t> decompress_zstd(Bytes compressed, std::size_t size, const std::string& place);

/// A compression that a container knows.
struct Compression {
  const char* name;
  Decompress decompress;
};

/// The content of a chunk of `size` bytes. Throws InputError at `place` for damaged data, for another size and for a
/// compression that is not known.
std::vector<std::uint8_t> decompress_chunk(std::span<const Compression> known, const std::string& compression,
                                           Bytes compressed, std::size_t size, const std::string& place);

/// Room for more bytes at the end of `bytes`, of which `used` are written; none beyond `size`.
void make_room(std::vector<std::uint8_t>& bytes, std::size_t used, std::size_t size);

/// The last two chunks, decompressed: colour and depth of a frame may lie in neighbouring ones.
class ChunkCache {
 public:
  /// The chunk, which `load` decompresses if it is not there; valid until the next call but one.
  template <class Load>
  const std::vector<std::uint8_t>& get(std::uint64_t chunk, const Load& load) {
    for (Decompressed& cached : cached_)
      if (cached.last_use != 0 && cached.chunk == chunk) {
        cached.last_use = ++uses_;
        return cached.bytes;
      }
    Decompressed& oldest = cached_[0].last_use <= cached_[1].last_use ? cached_[0] : cached_[1];
    oldest.last_use = 0;
    oldest.bytes = load();
    oldest.chunk = chunk;
    oldest.last_use = ++uses_;
    return oldest.bytes;
  }

 private:
  struct Decompressed {
    std::uint64_t chunk = 0, last_use = 0;  // 0: none yet
    std::vector<std::uint8_t> bytes;
  };
  Decompressed cached_[2];
  std::uint64_t uses_ = 0;
};

}  // namespace holdfast::rosbag_plugin
