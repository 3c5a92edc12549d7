// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "byte_reader.hpp"

namespace holdfast::rosbag_plugin {

/// A topic of a bag, and the type of its messages, such as "sensor_msgs/Image".
struct BagTopic {
  std::string name, type;
  std::uint64_t messages = 0;
};

/// Where a message lies in a bag.
struct BagMessage {
  std::uint64_t time = 0;  ///< when it was received [ns]
  std::uint32_t chunk = 0;
  std::uint32_t offset = 0;  ///< of its record in the chunk, decompressed
  std::uint32_t connection = 0;
};

/// Reads a bag of ROS 1 in the format 2.0 (wiki.ros.org/Bags/Format/2.0) through its index: chunks are read one by one
/// and when they are needed. ROS' own library is not used, because it trusts the file, searches the disk for packages
/// of ROS and loads Python. Every size is compared with what the file has before it is used. Used by one thread.
class BagFile {
 public:
  /// Reads the index. Throws InputError for what is no bag, and for a bag that is truncated or has no index.
  explicit BagFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// Sorted by name.
  std::vector<BagTopic> topics() const;
  /// The messages of a topic as they were received.
  std::vector<BagMessage> messages(const std::string& topic) const;
  /// The first `count` bytes of a message, or all of a shorter one; of an uncompressed chunk nothing else is read.
  /// Valid until the next call.
  Bytes head(const BagMessage& message, std::size_t count);
  /// All bytes of a message; valid until the next call.
  Bytes content(const BagMessage& message);
  /// The file, topic and time of a message, for errors.
  std::string place_of(const BagMessage& message) const;

 private:
  struct Record {
    std::map<std::string, std::string> fields;
    std::uint64_t content = 0, size = 0;  // position in the file, and number of bytes
    std::uint64_t end() const { return content + size; }
  };
  struct Connection {
    std::string topic, type;
  };
  struct Chunk {
    std::uint64_t position = 0, stored_size = 0;
    std::uint32_t size = 0;  // decompressed
    std::string compression;
  };
  struct Decompressed {
    std::uint32_t chunk = 0;
    std::uint64_t last_use = 0;  // 0: none yet
    std::vector<std::uint8_t> bytes;
  };

  std::uint64_t read_header();
  void read_connection(const Record& record);
  void read_chunk_info(const Record& record);
  void read_index(const Record& record, std::uint32_t chunk);
  Bytes content_in(const BagMessage& message, std::uint64_t most);
  const std::vector<std::uint8_t>& decompressed(std::uint32_t chunk);
  Record read_record(std::uint64_t position, std::uint64_t end, const char* what);
  void read_bytes(std::uint64_t position, std::uint64_t count, std::vector<std::uint8_t>& bytes);
  void check_message(const std::map<std::string, std::string>& fields, const BagMessage& message) const;
  [[noreturn]] void fail(const std::string& problem) const;

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, entries_ = 0;  // bytes of the file, entries of its index
  std::map<std::uint32_t, Connection> connections_;
  std::vector<Chunk> chunks_;
  std::map<std::uint32_t, std::vector<BagMessage>> messages_;  // by connection
  std::vector<std::uint8_t> buffer_;
  Decompressed cache_[2];  // colour and depth of a frame may lie in neighbouring chunks
  std::uint64_t uses_ = 0;
};

}  // namespace holdfast::rosbag_plugin
