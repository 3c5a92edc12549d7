// SPDX-License-Identifier: BSD-3-Clause
#include "live_client.hpp"

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "holdfast/core/byte_writer.hpp"

namespace holdfast::foxglove_plugin {

namespace {

using Json = nlohmann::json;

/// A whole number of 32 bits in a request, or nothing.
std::optional<std::uint32_t> number_in(const Json& request, const char* name) {
  const auto found = request.is_object() ? request.find(name) : request.end();
  if (found == request.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > UINT32_MAX) return {};
  return found->get<std::uint32_t>();
}

/// The entries of a list in a request; none if there is no list.
const Json& list_in(const Json& request, const char* name) {
  static const Json none = Json::array();
  const auto found = request.find(name);
  return found != request.end() && found->is_array() ? *found : none;
}

/// What a client sent; null if that is no JSON, or nested more deeply than any request.
Json parsed(std::string_view message) {
  constexpr int deepest = 16;
  bool is_too_deep = false;
  Json request = Json::parse(
      message,
      [&](int depth, Json::parse_event_t, const Json&) {
        is_too_deep = is_too_deep || depth > deepest;
        return depth <= deepest;
      },
      false);
  return is_too_deep ? Json() : request;
}

Json advertisement(const std::vector<mcap::Channel>& channels) {
  Json list = Json::array();
  for (const mcap::Channel& channel : channels)
    list.push_back({{"id", list.size() + 1},
                    {"topic", channel.topic},
                    {"encoding", channel.message_encoding},
                    {"schemaName", channel.schema_name},
                    {"schemaEncoding", channel.schema_encoding},
                    {"schema", channel.schema}});
  return {{"op", "advertise"}, {"channels", std::move(list)}};
}

}  // namespace

LiveClient::LiveClient(LiveChannels& channels, const std::string& session) : channels_(channels) {
  const Json information = {{"op", "serverInfo"},
                            {"name", "holdfast"},
                            {"capabilities", Json::array()},
                            {"supportedEncodings", Json::array()},
                            {"metadata", Json::object()},
                            {"sessionId", session}};
  texts_.push_back(information.dump());
  texts_.push_back(advertisement(channels_.channels()).dump());
}

LiveClient::~LiveClient() {
  for (const auto& [subscription, channel] : channel_of_) channels_.count_subscription(channel, -1);
}

std::optional<SocketMessage> LiveClient::next() {
  if (!texts_.empty()) {
    SocketMessage message{std::move(texts_.front()), true};
    texts_.pop_front();
    return message;
  }
  while (!messages_.empty()) {
    const std::shared_ptr<const LiveMessage> message = std::move(messages_.front());
    messages_.pop_front();
    waiting_ -= message->bytes().size();
    if (messages_.empty()) has_dropped_ = false;
    const auto subscription = subscription_of_.find(message->channel);
    if (subscription == subscription_of_.end()) continue;  // it ended meanwhile
    constexpr std::uint8_t message_data = 0x01;
    ByteWriter writer;
    writer.put(message_data);
    writer.put(subscription->second.id);
    writer.put(message->time);
    writer.put_bytes(message->bytes());
    return SocketMessage{writer.bytes(), false};
  }
  return std::nullopt;
}

void LiveClient::add(const std::shared_ptr<const LiveMessage>& message) {
  const auto subscription = subscription_of_.find(message->channel);
  if (subscription == subscription_of_.end() || message->number <= subscription->second.number) return;
  subscription->second.number = message->number;
  messages_.push_back(message);
  waiting_ += message->bytes().size();
  while (waiting_ > max_waiting && messages_.size() > 1) {
    waiting_ -= messages_.front()->bytes().size();
    messages_.pop_front();
    if (!std::exchange(has_dropped_, true)) say(Level::warning, "messages are dropped: the connection is too slow");
  }
}

bool LiveClient::receive(std::string_view message, bool is_text) {
  const Json request = is_text ? parsed(message) : Json();
  const auto op = request.is_object() ? request.find("op") : request.end();
  if (op == request.end() || !op->is_string()) {
    say(Level::error, "expected a JSON object with the field op");
    return true;
  }
  if (*op == "subscribe")
    subscribe(request);
  else if (*op == "unsubscribe")
    unsubscribe(request);
  else
    say(Level::warning, "the operation '" + op->get<std::string>() + "' is not supported");
  return true;
}

void LiveClient::subscribe(const Json& request) {
  const std::size_t count = channels_.channels().size();
  for (const Json& entry : list_in(request, "subscriptions")) {
    const auto id = number_in(entry, "id"), channel = number_in(entry, "channelId");
    if (!id || !channel || *channel < 1 || *channel > count) {
      say(Level::error, "a subscription needs an id and the channelId of an advertised channel");
      continue;
    }
    const auto number = static_cast<std::uint16_t>(*channel);
    if (channel_of_.contains(*id) || subscription_of_.contains(number)) {
      say(Level::error, "the subscription " + std::to_string(*id) + " or one to its channel is there already");
      continue;
    }
    channel_of_[*id] = number;
    subscription_of_[number] = {.id = *id};
    channels_.count_subscription(number, +1);
    if (const auto last = channels_.last_of(number)) add(last);
  }
}

void LiveClient::unsubscribe(const Json& request) {
  for (const Json& entry : list_in(request, "subscriptionIds")) {
    const auto found = entry.is_number_unsigned() && entry.get<std::uint64_t>() <= UINT32_MAX
                           ? channel_of_.find(entry.get<std::uint32_t>())
                           : channel_of_.end();
    if (found == channel_of_.end()) {
      say(Level::error, "there is no such subscription");
      continue;
    }
    channels_.count_subscription(found->second, -1);
    subscription_of_.erase(found->second);
    channel_of_.erase(found);
  }
}

void LiveClient::say(Level level, const std::string& text) {
  constexpr std::size_t most = 100;  // of a client that does not read
  if (texts_.size() >= most) return;
  const Json status = {{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}};
  texts_.push_back(status.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace holdfast::foxglove_plugin
