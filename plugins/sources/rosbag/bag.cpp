// SPDX-License-Identifier: BSD-3-Clause
#include "bag.hpp"

#include <algorithm>
#include <tuple>

namespace holdfast::rosbag_plugin {

bool Bag::add_connection(std::uint32_t number, Connection connection) {
  if (const std::size_t middle = connection.type.find("/msg/"); middle != std::string::npos)
    connection.type.erase(middle, 4);
  return connections_.emplace(number, std::move(connection)).second;
}

std::vector<BagTopic> Bag::topics() const {
  std::map<std::string, BagTopic> topics;
  for (const auto& [number, connection] : connections_) {
    BagTopic& topic = topics[connection.topic];
    topic.name = connection.topic;
    topic.type = connection.type;
    topic.encoding_name = connection.encoding_name;
    topic.messages += connection.messages.size();
  }
  std::vector<BagTopic> list;
  for (auto& [name, topic] : topics) list.push_back(std::move(topic));
  return list;
}

std::vector<BagMessage> Bag::messages(const std::string& topic) const {
  std::vector<BagMessage> list;
  for (const auto& [number, connection] : connections_)
    if (connection.topic == topic) list.insert(list.end(), connection.messages.begin(), connection.messages.end());
  std::stable_sort(list.begin(), list.end(), [](const BagMessage& a, const BagMessage& b) {
    return std::tie(a.time, a.connection, a.chunk, a.offset) < std::tie(b.time, b.connection, b.chunk, b.offset);
  });
  return list;
}

std::string Bag::place_of(const BagMessage& message) const {
  std::string nanoseconds = std::to_string(message.time % 1'000'000'000);
  nanoseconds.insert(0, 9 - nanoseconds.size(), '0');
  return path_.string() + ": message of " + connections_.at(message.connection).topic + " at " +
         std::to_string(message.time / 1'000'000'000) + '.' + nanoseconds + " s";
}

Message Bag::with_bytes(const BagMessage& message, std::uint64_t most) {
  const Connection& of = connections_.at(message.connection);
  const MessageEncoding* encoding = find_encoding(of.encoding_name);
  std::string place = place_of(message);
  if (encoding == nullptr)
    throw InputError({place}, "is serialised as '" + of.encoding_name + "'; expected ros1 or cdr");
  return {read(message, most), of.type, encoding, std::move(place)};
}

}  // namespace holdfast::rosbag_plugin
