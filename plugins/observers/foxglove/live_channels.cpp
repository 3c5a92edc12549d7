// SPDX-License-Identifier: BSD-3-Clause
#include "live_channels.hpp"

#include <utility>

namespace holdfast::foxglove_plugin {

std::uint16_t LiveChannels::add_channel(const mcap::Channel& channel) {
  const std::lock_guard lock(mutex_);
  channels_.push_back(channel);
  return static_cast<std::uint16_t>(channels_.size());
}

bool LiveChannels::wants(std::uint16_t channel) const {
  const std::lock_guard lock(mutex_);
  const auto found = subscriptions_.find(channel);
  return found != subscriptions_.end() && found->second > 0;
}

void LiveChannels::write(std::uint16_t channel, std::uint64_t time, std::string_view message) {
  auto shared = std::make_shared<LiveMessage>(channel, time, std::string(message));
  const std::lock_guard lock(mutex_);
  shared->number = ++written_;
  messages_.push_back(std::move(shared));
}

void LiveChannels::write_state(std::uint16_t channel, std::uint64_t time, std::function<std::string()> make) {
  auto shared = std::make_shared<LiveMessage>(channel, time, std::move(make));
  std::shared_ptr<const LiveMessage> earlier;  // its content is freed without the lock
  const std::lock_guard lock(mutex_);
  shared->number = ++written_;
  earlier = std::exchange(last_[channel], shared);
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

int LiveChannels::subscriptions() const {
  const std::lock_guard lock(mutex_);
  int sum = 0;
  for (const auto& [channel, count] : subscriptions_) sum += count;
  return sum;
}

}  // namespace holdfast::foxglove_plugin
