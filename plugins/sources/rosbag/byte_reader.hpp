// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast::rosbag_plugin {

using Bytes = std::span<const std::uint8_t>;

/// Reads numbers, texts and bytes one after the other, and never beyond the end. Numbers are little-endian, as in bags
/// of ROS 1, MCAP files and messages of ROS 1, on every machine that Holdfast is built for.
class ByteReader {
 public:
  /// `place` names the file and what the bytes are, for errors.
  ByteReader(Bytes bytes, std::string place) : bytes_(bytes), place_(std::move(place)) {}

  template <class Number>
  Number number(const char* what) {
    static_assert(std::is_arithmetic_v<Number>);
    Number value;
    std::memcpy(&value, bytes(sizeof(value), what).data(), sizeof(value));
    return value;
  }
  /// A length of 32 bits, and as many bytes.
  Bytes counted_bytes(const char* what) { return bytes(number<std::uint32_t>(what), what); }
  std::string text(const char* what) {
    const Bytes characters = counted_bytes(what);
    return {characters.begin(), characters.end()};
  }
  Bytes bytes(std::size_t count, const char* what) {
    if (count > bytes_.size())
      throw InputError({place_}, std::string("is cut short: its ") + what + " takes " + std::to_string(count) +
                                     " bytes, and " + std::to_string(bytes_.size()) +
                                     " are left; copy the bag again, or record it again");
    const Bytes taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  Bytes bytes_;
  std::string place_;
};

}  // namespace holdfast::rosbag_plugin
