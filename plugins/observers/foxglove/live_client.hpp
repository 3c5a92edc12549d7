// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "holdfast/web_server/socket_server.hpp"
#include "live_channels.hpp"

namespace holdfast::foxglove_plugin {

/// One connection by Foxglove's WebSocket protocol, version 1 (github.com/foxglove/ws-protocol, docs/spec.md), without
/// optional capabilities: announces itself and the topics, and sends the messages of those that the client subscribes
/// to. What a client asks beyond that is answered by a status message. Used by the thread of the server.
class LiveClient final : public SocketClient {
 public:
  /// Messages that wait for a slow client [bytes]; beyond it the oldest ones are dropped, and the client is told.
  static constexpr std::size_t max_waiting = 32U << 20;

  /// `channels` must outlive the client. `session`: tells a client whether it came back to the same run.
  LiveClient(LiveChannels& channels, const std::string& session);
  ~LiveClient() override;
  LiveClient(const LiveClient&) = delete;
  LiveClient& operator=(const LiveClient&) = delete;

  std::optional<SocketMessage> next() override;
  bool receive(std::string_view message, bool is_text) override;
  /// Queues a message if there is a subscription to its topic, and the client had no later one of it.
  void add(const std::shared_ptr<const LiveMessage>& message);

 private:
  enum class Level { information = 0, warning = 1, error = 2 };
  struct Subscription {
    std::uint32_t id = 0;
    std::uint64_t number = 0;  // of the last message
  };
  void say(Level level, const std::string& text);
  void subscribe(const nlohmann::json& request);
  void unsubscribe(const nlohmann::json& request);

  LiveChannels& channels_;
  std::deque<std::string> texts_;  // before messages, because they announce them
  std::deque<std::shared_ptr<const LiveMessage>> messages_;
  std::size_t waiting_ = 0;                            // bytes of messages_
  bool has_dropped_ = false;                           // since messages_ was empty
  std::map<std::uint32_t, std::uint16_t> channel_of_;  // a subscription
  std::map<std::uint16_t, Subscription> subscription_of_;
};

}  // namespace holdfast::foxglove_plugin
