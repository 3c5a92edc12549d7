// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/warning.hpp"
#include "message.hpp"

namespace holdfast::rosbag_plugin {

/// A topic of a recording, and the type of its messages.
struct BagTopic {
  std::string name;
  std::string type;           ///< as Message::type
  std::string encoding_name;  ///< as the recording has it, such as "cdr"
  std::uint64_t messages = 0;

  bool is_readable() const { return find_encoding(encoding_name) != nullptr; }
};

/// Where a message lies in a recording.
struct BagMessage {
  std::uint64_t time = 0;        ///< when it was received [ns]
  std::uint32_t connection = 0;  ///< of Bag
  std::uint32_t chunk = 0;       ///< what contains it, as the container counts
  std::uint64_t offset = 0;      ///< in what contains it, or its number, as the container counts
};

/// A recording of messages: the interface of all containers. A connection is a topic with one type and encoding.
/// Containers fill the index when they are constructed, and read messages when they are needed. They throw InputError
/// for what is damaged, and compare every size with what the file has before it is used. Used by one thread.
class Bag {
 public:
  explicit Bag(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~Bag() = default;
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;

  /// The file or folder, for errors.
  const std::filesystem::path& path() const { return path_; }
  /// Sorted by name.
  std::vector<BagTopic> topics() const;
  /// The messages of a topic as they were received.
  std::vector<BagMessage> messages(const std::string& topic) const;
  /// The first `count` bytes of a message, or all of a shorter one, without reading the rest where that can be.
  /// The message must be of a topic whose encoding is readable, here and below; bytes are valid until the next call.
  Message head(const BagMessage& message, std::size_t count) { return with_bytes(message, count); }
  Message content(const BagMessage& message) { return with_bytes(message, ~std::uint64_t{0}); }
  /// The file, topic and time of a message, for errors.
  virtual std::string place_of(const BagMessage& message) const;
  /// What the recording lacks, such as its end.
  const Warnings& warnings() const { return warnings_; }

  struct Connection {
    std::string topic, type, encoding_name;
    std::vector<BagMessage> messages;
  };
  const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
  /// At most `most` bytes of a message, as they lie in the file.
  virtual Bytes read(const BagMessage& message, std::uint64_t most) = 0;

 protected:
  /// Whether there was none of this number. Removes the "msg" of ROS 2 from the type.
  bool add_connection(std::uint32_t number, Connection connection);
  bool has_connection(std::uint32_t number) const { return connections_.contains(number); }
  const Connection& connection(std::uint32_t number) const { return connections_.at(number); }
  void add_message(const BagMessage& message) { connections_.at(message.connection).messages.push_back(message); }
  void suspect(const std::string& suspicion) { add_warning(warnings_, {{path_.string()}, suspicion}); }
  void add_suspicions(const Warnings& warnings) { add_warnings(warnings_, warnings); }
  [[noreturn]] void fail(const std::string& problem) const { throw InputError({path_.string()}, problem); }

 private:
  Message with_bytes(const BagMessage& message, std::uint64_t most);

  std::filesystem::path path_;
  std::map<std::uint32_t, Connection> connections_;
  Warnings warnings_;
};

/// Opens a recording of any kind: a bag of ROS 1, an MCAP file, a database of rosbag2, or a folder of rosbag2. Throws
/// InputError that says what the path is if it is none of these.
std::unique_ptr<Bag> open_bag(const std::filesystem::path& path);

}  // namespace holdfast::rosbag_plugin
