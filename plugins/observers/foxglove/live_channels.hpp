// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "holdfast/mcap/message_sink.hpp"

namespace holdfast::foxglove_plugin {

/// A message of a topic, shared by all clients.
struct LiveMessage {
  std::uint16_t channel = 0;
  std::uint64_t time = 0;  ///< [ns]
  std::string bytes;
};

/// Topics and messages between the threads of the pipeline, which write, and that of the server, which hands them to
/// its clients. Nothing is kept for clients that come later but the last message of each topic of the map. Any thread.
class LiveChannels final : public mcap::MessageSink {
 public:
  std::uint16_t add_channel(const mcap::Channel& channel) override;
  /// Topics of the map, and those with a subscription.
  bool wants(std::uint16_t channel) const override;
  void write(std::uint16_t channel, std::uint64_t time, std::string_view message) override;

  /// The topics so far; number i + 1 is entry i.
  std::vector<mcap::Channel> channels() const;
  /// The messages that were written since the last call.
  std::vector<std::shared_ptr<const LiveMessage>> take_messages();
  /// The last message of a topic of the map; null for others, and before the first one.
  std::shared_ptr<const LiveMessage> last_of(std::uint16_t channel) const;
  /// Counts subscriptions: +1 or -1.
  void count_subscription(std::uint16_t channel, int difference);

 private:
  mutable std::mutex mutex_;
  std::vector<mcap::Channel> channels_;
  std::map<std::uint16_t, int> subscriptions_;
  std::map<std::uint16_t, std::shared_ptr<const LiveMessage>> last_;
  std::vector<std::shared_ptr<const LiveMessage>> messages_;
};

}  // namespace holdfast::foxglove_plugin
