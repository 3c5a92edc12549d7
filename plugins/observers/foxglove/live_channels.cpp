// SPDX-License-Identifier: BSD-3-Clause
#include "live_channels.hpp"

#include <utility>

namespace holdfast::foxglove_plugin {

namespace {

/// States, not events: a client that subscribes later needs the last one.
bool is_of_map(const mcap::Channel& channel) { return channel.topic.starts_with("/map/"); }

}  // namespace

std::uint16_t LiveChannels::add_channel(const mcap::Channel& channel) {
  const std::lock_guard lock(mutex_);
  channels_.push_back(channel);
  return static_cast<std::uint16_t>(channels_.size());
}

bool LiveChannels::wants(std::uint16_t channel) const {
  const std::lock_guard lock(mutex_);
  const auto found = subscriptions_.find(channel);
  return is_of_map(channels_[channel - 1U]) || (found != subscriptions_.end() && found->second > 0);
}

void LiveChannels::write(std::uint16_t channel, std::uint64_t time, std::string_view message) {
  auto shared = std::make_shared<const LiveMessage>(LiveMessage{channel, time, std::string(message)});
  const std::lock_guard lock(mutex_);
  if (is_of_map(channels_[channel - 1U])) last_[channel] = shared;
  messages_.push_back(std::move(shared));
}

std::vector<mcap::Channel> LiveChannels::channels() const {
  const std::lock_guard lock(mutex_);
  return channels_;
}

std::vector<std::shared_ptr<const LiveMessage>> LiveChannels::take_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

std::shared_ptr<const LiveMessage> LiveChannels::last_of(std::uint16_t channel) const {
  const std::lock_guard lock(mutex_);
  const auto found = last_.find(channel);
  return found == last_.end() ? nullptr : found->second;
}

void LiveChannels::count_subscription(std::uint16_t channel, int difference) {
  const std::lock_guard lock(mutex_);
  subscriptions_[channel] += difference;
}

}  // namespace holdfast::foxglove_plugin
