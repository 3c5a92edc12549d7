// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace holdfast::test {

/// Bytes in the order in which ROS and its bags have them.
class ByteText {
 public:
  template <class Number>
  ByteText& number(Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  ByteText& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes += value;
    return *this;
  }
  std::string bytes;
};

/// Messages of sensor_msgs, as they lie in bags. Stamps in nanoseconds.
std::string image_message(std::uint64_t stamp, const std::string& encoding, const cv::Mat& pixels);
/// With sizes and bytes that need not fit together.
std::string image_message(std::uint64_t stamp, const std::string& encoding, std::uint32_t width, std::uint32_t height,
                          std::uint32_t step, const std::string& bytes);
std::string compressed_message(std::uint64_t stamp, const std::string& format, const std::string& bytes);
std::string camera_info_message(std::uint64_t stamp, std::uint32_t width, std::uint32_t height,
                                const std::string& model, const std::vector<double>& distortion,
                                const std::vector<double>& k, const std::vector<double>& p = std::vector<double>(12));

/// An image of ROS 2: sensor_msgs/msg/Image in CDR, little-endian.
std::string cdr_image_message(std::uint64_t stamp, const std::string& encoding, const cv::Mat& pixels);

/// Writes MCAP files of ROS 2 without chunks, index and checksum, in memory.
class McapWriter {
 public:
  McapWriter();
  void add(const std::string& topic, const std::string& type, std::uint64_t time, const std::string& message);
  /// The whole file. The writer must not be used afterwards.
  std::string finish();

 private:
  void add_record(std::uint8_t kind, const std::string& content);

  std::string bytes_;
  std::map<std::string, std::uint16_t> channels_;
};

/// Writes bags of ROS 1 in the format 2.0, in memory.
class BagWriter {
 public:
  /// `compression`: none, bz2 or lz4. A chunk ends after so many messages.
  explicit BagWriter(std::string compression = "none", int messages_in_chunk = 3)
      : compression_(std::move(compression)), messages_in_chunk_(messages_in_chunk) {}

  void add(const std::string& topic, const std::string& type, std::uint64_t time, const std::string& message);
  /// The whole file. The bag must not be used afterwards.
  std::string finish();

 private:
  struct Connection {
    std::uint32_t id = 0;
    std::string topic, type;
  };
  void end_chunk();
  static std::string record(const std::map<std::string, std::string>& fields, const std::string& content);
  static std::string connection_record(const Connection& connection);

  std::string compression_;
  int messages_in_chunk_;
  std::vector<Connection> connections_;
  std::string chunks_, infos_, chunk_;
  std::map<std::uint32_t, std::string> index_;  // of the chunk, by connection
  int in_chunk_ = 0;
  std::uint32_t chunk_count_ = 0;
};

}  // namespace holdfast::test
