// SPDX-License-Identifier: BSD-3-Clause
#include "split_bag.hpp"

#include <algorithm>

#include "chunk.hpp"
#include "zstd_file.hpp"

namespace holdfast::rosbag_plugin {

SplitBag::SplitBag(const std::filesystem::path& path, std::vector<std::unique_ptr<Bag>> parts)
    : Bag(path), parts_(std::move(parts)) {
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    for (const auto& [number, connection] : parts_[part]->connections()) {
      const auto own_number = static_cast<std::uint32_t>(origins_.size());
      origins_.push_back({part, number});
      add_connection(own_number, {connection.topic, connection.type, connection.encoding_name, {}});
      for (BagMessage message : connection.messages) {
        message.connection = own_number;
        add_message(message);
      }
    }
    add_suspicions(parts_[part]->warnings());
  }
}

std::pair<Bag*, BagMessage> SplitBag::message_in_part(const BagMessage& message) const {
  const Origin& origin = origins_[message.connection];
  BagMessage own = message;
  own.connection = origin.connection;
  return {parts_[origin.part].get(), own};
}

std::string SplitBag::place_of(const BagMessage& message) const {
  const auto& [part, own] = message_in_part(message);
  return part->place_of(own);
}

Bytes SplitBag::read(const BagMessage& message, std::uint64_t most) {
  const auto& [part, own] = message_in_part(message);
  const Bytes begin = part->read(own, std::max<std::uint64_t>(most, stamp_bytes));
  const auto has_magic = [](Bytes bytes) {
    return bytes.size() >= 4 &&
           std::equal(bytes.begin(), bytes.begin() + 4, reinterpret_cast<const std::uint8_t*>(zstd_magic));
  };
  // No message in CDR begins so: its first byte is zero.
  if (connection(message.connection).encoding_name != "cdr" || !has_magic(begin))
    return begin.first(std::min<std::uint64_t>(begin.size(), most));
  const Bytes compressed = most < largest_chunk ? part->read(own, ~std::uint64_t{0}) : begin;
  const std::string place = place_of(message);
  buffer_ = decompress_zstd(compressed, std::min<std::uint64_t>(most, largest_chunk), place);
  if (buffer_.size() > largest_chunk)
    throw InputError({place}, "has more than " + std::to_string(largest_chunk) + " bytes, decompressed; it is damaged");
  return Bytes(buffer_).first(std::min<std::uint64_t>(buffer_.size(), most));
}

}  // namespace holdfast::rosbag_plugin
