// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "holdfast/mcap/message_sink.hpp"

namespace holdfast {
class ByteWriter;
}

namespace holdfast::mcap {

/// Compression of the chunks of a file.
enum class Compression {
  none,
  zstd,  ///< the fastest level; none in a build without zstd
};

/// Writes an MCAP file (mcap.dev/spec): chunks of about 1 MB with their indexes, and the summary at the end. A file
/// whose writer ended early can be read up to its last chunk. One thread; methods throw InputError with the system's
/// reason if a write fails, and again the first one of them after that.
class McapWriter final : public MessageSink {
 public:
  /// `profile`: conventions of topics and messages, such as "ros2"; empty = none. Replaces an existing file.
  explicit McapWriter(std::filesystem::path file, const std::string& profile = {},
                      Compression compression = Compression::none);

  std::uint16_t add_channel(const Channel& channel) override;
  void write(std::uint16_t channel, std::uint64_t time, std::string_view message) override;
  /// Completes the file.
  void close();

 private:
  struct Definition : Channel {
    std::uint64_t messages = 0;
  };
  /// A chunk in the file. `stored`: its bytes there, `size`: without compression.
  struct ChunkIndex {
    std::uint64_t begin = 0, end = 0;  // times of its messages
    std::uint64_t offset = 0, length = 0, stored = 0, size = 0, index_length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };

  void put(std::string_view bytes);
  void put_chunk();
  void put_message_indexes(ChunkIndex& index);
  const char* compression_name() const;
  std::string definitions() const;
  ByteWriter content_of(const ChunkIndex& chunk) const;
  std::string statistics() const;
  [[noreturn]] void fail();

  std::filesystem::path file_;
  Compression compression_;
  std::ofstream stream_;
  std::string failure_;  // the first one; empty = none
  std::uint64_t written_ = 0;
  std::vector<Definition> channels_;  // channel i + 1 has the schema i + 1
  std::size_t channels_written_ = 0;
  std::string chunk_;
  std::uint64_t chunk_begin_ = 0, chunk_end_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;  // time and offset
  std::vector<ChunkIndex> chunks_;
};

}  // namespace holdfast::mcap
