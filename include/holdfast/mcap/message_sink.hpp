// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace holdfast::mcap {

/// A topic with the type of its messages, in the terms of MCAP.
struct Channel {
  std::string topic;
  std::string message_encoding;  ///< such as "json" or "cdr"
  std::string schema_name;       ///< such as "foxglove.PoseInFrame" or "sensor_msgs/msg/Image"
  std::string schema_encoding;   ///< such as "jsonschema" or "ros2msg"
  std::string schema;            ///< the definition of the type
};

/// A destination of serialised messages: a file or a live connection.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  /// Adds a topic, and returns its number, which is at least 1.
  virtual std::uint16_t add_channel(const Channel& channel) = 0;
  /// False if nobody would get a message of the topic, so that it need not be made.
  virtual bool wants(std::uint16_t /*channel*/) const { return true; }
  /// `time`: log and publish time [ns].
  virtual void write(std::uint16_t channel, std::uint64_t time, std::string_view message) = 0;
  /// The new state of a topic, which whoever comes later needs as well. `make` gives the message; it may be called
  /// later, by another thread, or never.
  virtual void write_state(std::uint16_t channel, std::uint64_t time, std::function<std::string()> make) {
    write(channel, time, make());
  }
};

}  // namespace holdfast::mcap
