// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bag.hpp"
#include "chunk.hpp"
#include "holdfast/core/input_file.hpp"

namespace holdfast::rosbag_plugin {

/// The first bytes of an MCAP file, and its last ones.
inline constexpr const char* mcap_magic = "\x89MCAP0\r\n";

/// Reads an MCAP file (mcap.dev/spec). All records are read in their order once, and the checksums of chunks and of the
/// data are compared; indexes and summaries are not used, so that they may be missing. Of a file that is cut off, what
/// is complete is read, and a warning says so; damage elsewhere is an error.
class McapFile final : public Bag {
 public:
  /// `file` has the bytes, and `shown` is its name for errors.
  McapFile(const std::filesystem::path& file, const std::filesystem::path& shown);

  Bytes read(const BagMessage& message, std::uint64_t most) override;

 private:
  /// Bytes that hold records: a part of the file, or a decompressed chunk.
  struct Region {
    std::function<Bytes(std::uint64_t position, std::uint64_t count)> bytes;
    std::uint64_t begin = 0, end = 0;
    std::uint32_t chunk = 0;  // 0: the file
    bool is_of_chunk = false;
    std::string place;
  };
  struct Record {
    std::uint8_t kind = 0;
    std::uint64_t content = 0, size = 0;  // position in its region, and number of bytes
    std::uint64_t end() const { return content + size; }
  };
  struct Chunk {
    std::uint64_t position = 0, stored_size = 0, size = 0;
    std::string compression;
  };
  /// Where the bytes of a message lie in its region, and the first of them, which stamps are read from.
  struct Place {
    std::uint64_t position = 0, size = 0;
    std::array<std::uint8_t, stamp_bytes> head{};
  };
  struct Schema {
    std::string name;
  };

  Region region_of_file(std::uint64_t begin, std::uint64_t end, bool is_of_chunk, const std::string& place);
  std::optional<Record> record_at(const Region& region, std::uint64_t position) const;
  void read_records();
  void end_at(std::uint64_t position, bool has_data_end);
  void read_small_record(const Region& region, const Record& record);
  void read_schema(Bytes content, const std::string& place);
  void read_channel(Bytes content, const std::string& place);
  void read_message(const Region& region, const Record& record);
  void read_chunk(const Record& record);
  void read_chunk_records(const Region& region);
  void check_data(const Record& data_end);
  void check_count(const Record& statistics);
  void check_sum(std::uint64_t begin, std::uint64_t end, std::uint32_t expected, const std::string& place);
  std::vector<std::uint8_t> decompress(const Chunk& chunk, const std::string& place);
  Bytes file_bytes(std::uint64_t position, std::uint64_t count);

  InputFile file_;
  std::map<std::uint16_t, Schema> schemas_;
  std::vector<Chunk> chunks_;          // those that are compressed; BagMessage::chunk - 1
  std::vector<Place> messages_;        // BagMessage::offset
  bool has_messages_outside_ = false;  // of chunks
  std::vector<std::uint8_t> buffer_;
  ChunkCache cache_;
};

}  // namespace holdfast::rosbag_plugin
