// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "holdfast/mcap/message_sink.hpp"

namespace holdfast::foxglove_plugin {

/// A message of a topic, shared by all clients. Used by the thread of the server.
class LiveMessage {
 public:
  LiveMessage(std::uint16_t message_channel, std::uint64_t message_time, std::string bytes)
      : channel(message_channel), time(message_time), bytes_(std::move(bytes)) {}
  LiveMessage(std::uint16_t message_channel, std::uint64_t message_time, std::function<std::string()> make)
      : channel(message_channel), time(message_time), make_(std::move(make)) {}

  const std::uint16_t channel;
  const std::uint64_t time;  ///< [ns]
  std::uint64_t number = 0;  ///< grows with each message of a run
  /// Made by the first call.
  const std::string& bytes() const {
    if (!bytes_) bytes_ = std::exchange(make_, nullptr)();
    return *bytes_;
  }

 private:
  mutable std::function<std::string()> make_;
  mutable std::optional<std::string> bytes_;
};

/// Topics and messages between the threads of the pipeline, which write, and that of the server, which hands them to
/// its clients. Nothing is kept for clients that come later but the last state of each topic that has states, which is
/// serialised when a client gets it, by the thread of the server. Any thread.
class LiveChannels final : public mcap::MessageSink {
 public:
  std::uint16_t add_channel(const mcap::Channel& channel) override;
  /// Topics with a subscription.
  bool wants(std::uint16_t channel) const override;
  void write(std::uint16_t channel, std::uint64_t time, std::string_view message) override;
  void write_state(std::uint16_t channel, std::uint64_t time, std::function<std::string()> make) override;

  /// The topics so far; number i + 1 is entry i.
  std::vector<mcap::Channel> channels() const;
  /// The messages that were written since the last call.
  std::vector<std::shared_ptr<const LiveMessage>> take_messages();
  /// The last state of a topic; null if it has none.
  std::shared_ptr<const LiveMessage> last_of(std::uint16_t channel) const;
  /// Counts subscriptions: +1 or -1.
  void count_subscription(std::uint16_t channel, int difference);
  /// The number of subscriptions.
  int subscriptions() const;

 private:
  mutable std::mutex mutex_;
  std::vector<mcap::Channel> channels_;
  std::map<std::uint16_t, int> subscriptions_;
  std::map<std::uint16_t, std::shared_ptr<const LiveMessage>> last_;
  std::vector<std::shared_ptr<const LiveMessage>> messages_;
  std::uint64_t written_ = 0;  // messages
};

}  // namespace holdfast::foxglove_plugin
