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

namespace holdfast {
class ByteWriter;
}

namespace holdfast::mcap_plugin {

/// Writes an MCAP file (mcap.dev/spec) with messages in JSON: uncompressed chunks of about 1 MB with their indexes, and
/// the summary at the end. A file whose writer ended early can be read up to its last chunk. One thread; methods throw
/// InputError with the system's reason if a write fails.
class McapWriter {
 public:
  explicit McapWriter(std::filesystem::path file);

  /// Adds a topic whose messages have a schema (a JSON Schema document) of this name; returns its number.
  std::uint16_t add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema);
  /// `time`: log and publish time [ns].
  void write(std::uint16_t channel, std::uint64_t time, std::string_view message);
  /// Completes the file.
  void close();

 private:
  struct Definition {
    std::string topic, schema_name, schema;
    std::uint64_t messages = 0;
  };
  struct ChunkIndex {
    std::uint64_t begin = 0, end = 0;  // times of its messages
    std::uint64_t offset = 0, length = 0, size = 0, index_length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };

  void put(std::string_view bytes);
  void put_chunk();
  std::string definitions() const;
  static ByteWriter content_of(const ChunkIndex& chunk);
  std::string statistics() const;
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::ofstream stream_;
  std::uint64_t written_ = 0;
  std::vector<Definition> channels_;  // channel i + 1 has the schema i + 1
  std::size_t channels_written_ = 0;
  std::string chunk_;
  std::uint64_t chunk_begin_ = 0, chunk_end_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_;  // time and offset
  std::vector<ChunkIndex> chunks_;
};

}  // namespace holdfast::mcap_plugin
