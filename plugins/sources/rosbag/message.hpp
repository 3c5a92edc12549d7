// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

#include "byte_reader.hpp"

namespace holdfast::rosbag_plugin {

/// A time stamp of a message's header.
struct MessageStamp {
  std::uint32_t seconds = 0, nanoseconds = 0;
};

/// Reads the fields of a serialised message one after the other, in the order of its definition. Every function throws
/// InputError that names `what` if the message ends before the field does.
class MessageReader {
 public:
  virtual ~MessageReader() = default;

  template <class Number>
  Number number(const char* what) {
    static_assert(std::is_arithmetic_v<Number>);
    Number value;
    read_number(&value, sizeof(value), what);
    return value;
  }
  virtual std::string text(const char* what) = 0;
  /// A sequence of bytes; valid as long as the message.
  virtual Bytes sequence(const char* what) = 0;
  /// The time stamp, which is the first field of std_msgs/Header that both versions of ROS have.
  virtual MessageStamp stamp() = 0;

 protected:
  virtual void read_number(void* value, std::size_t size, const char* what) = 0;
};

/// How the messages of a topic are serialised.
class MessageEncoding {
 public:
  virtual ~MessageEncoding() = default;
  /// `place` names the file and the message, for errors. Throws InputError for bytes that are of another encoding.
  virtual std::unique_ptr<MessageReader> open(Bytes message, const std::string& place) const = 0;
};

/// The serialisation of ROS 1: little-endian, without gaps.
const MessageEncoding& ros1_encoding();
/// The serialisation of ROS 2: the Common Data Representation of CORBA (XCDR1 of DDS-XTypes 1.3, 7.4.1), plain, of
/// either byte order, which its encapsulation header names. Numbers are aligned to their size.
const MessageEncoding& cdr_encoding();
/// The encoding that a recording calls "ros1" or "cdr"; null for another one.
const MessageEncoding* find_encoding(const std::string& name);

/// Bytes at the begin of a message that hold the time stamp of its header, in every encoding.
constexpr std::size_t stamp_bytes = 12;

/// A message of a recording. Its bytes are valid until the next message is read.
struct Message {
  Bytes bytes;
  std::string type;  ///< without the "msg" of ROS 2, such as "sensor_msgs/Image"
  const MessageEncoding* encoding = nullptr;
  std::string place;  ///< file, topic and time, for errors

  std::unique_ptr<MessageReader> open() const { return encoding->open(bytes, place); }
};

}  // namespace holdfast::rosbag_plugin
