// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bag.hpp"
#include "chunk.hpp"
#include "holdfast/core/input_file.hpp"

namespace holdfast::rosbag_plugin {

/// The first bytes of a bag.
inline constexpr const char* ros1_magic = "#ROSBAG V2.0\n";

/// Reads a bag of ROS 1 in the format 2.0 (wiki.ros.org/Bags/Format/2.0) through its index: chunks are read one by one
/// and when they are needed. ROS' own library is not used, because it trusts the file, searches the disk for packages
/// of ROS and loads Python.
class Ros1Bag final : public Bag {
 public:
  /// Reads the index. Throws InputError for a bag that is truncated or has no index. `file` has the bytes, and `shown`
  /// is its name for errors.
  Ros1Bag(const std::filesystem::path& file, const std::filesystem::path& shown);

  Bytes read(const BagMessage& message, std::uint64_t most) override;

 private:
  struct Record {
    std::map<std::string, std::string> fields;
    std::uint64_t content = 0, size = 0;  // position in the file, and number of bytes
    std::uint64_t end() const { return content + size; }
  };
  struct Chunk {
    std::uint64_t position = 0, stored_size = 0;
    std::uint32_t size = 0;  // decompressed
    std::string compression;
  };
  std::uint64_t read_header();
  void read_connection(const Record& record);
  void read_chunk_info(const Record& record);
  void read_index(const Record& record, std::uint32_t chunk);
  const std::vector<std::uint8_t>& decompressed(std::uint32_t number);
  Record read_record(std::uint64_t position, std::uint64_t end, const char* what);
  void read_bytes(std::uint64_t position, std::uint64_t count, std::vector<std::uint8_t>& bytes);
  void check_message(const std::map<std::string, std::string>& fields, const BagMessage& message) const;

  InputFile file_;
  std::uint64_t entries_ = 0;  // of the index
  std::vector<Chunk> chunks_;
  std::vector<std::uint8_t> buffer_;
  ChunkCache cache_;
};

}  // namespace holdfast::rosbag_plugin
