// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

/// Reading of the Protocol Buffers encoding: a message is a sequence of fields, each with a number and a value, which
/// may be a message again. Nothing is read beyond the bytes given.
namespace holdfast::protobuf {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t wire_varint = 0, wire_eight_bytes = 1, wire_content = 2, wire_four_bytes = 5;

/// Thrown for bytes that are not a message.
struct Malformed {};

struct Field {
  std::uint32_t number = 0;
  std::uint32_t wire = 0;   ///< how the value is encoded
  std::uint64_t value = 0;  ///< of a varint
  std::uint64_t bits = 0;   ///< of a value of four or eight bytes
  Bytes content;            ///< of a length-delimited field
};

/// The fields of a message, one after the other.
class Message {
 public:
  explicit Message(Bytes bytes) : rest_(bytes) {}

  bool is_at_end() const { return rest_.empty(); }
  std::optional<Field> next() {
    if (rest_.empty()) return std::nullopt;
    const std::uint64_t key = varint();
    Field result;
    result.number = static_cast<std::uint32_t>(key >> 3);
    if (result.number == 0) throw Malformed();
    result.wire = key & 7;
    switch (result.wire) {
      case wire_varint:
        result.value = varint();
        break;
      case wire_eight_bytes:
        result.bits = little_endian(take(8));
        break;
      case wire_content:
        result.content = take(varint());
        break;
      case wire_four_bytes:
        result.bits = little_endian(take(4));
        break;
      default:
        throw Malformed();
    }
    return result;
  }

  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = take(1)[0];
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if ((byte & 0x80) == 0) return value;
    }
    throw Malformed();
  }

 private:
  Bytes take(std::uint64_t count) {
    if (count > rest_.size()) throw Malformed();
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  static std::uint64_t little_endian(Bytes bytes) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) bits |= std::uint64_t{bytes[i]} << (8 * i);
    return bits;
  }

  Bytes rest_;
};

template <class Visit>
void each_field(Bytes bytes, Visit&& visit) {
  Message message(bytes);
  while (const std::optional<Field> found = message.next()) visit(*found);
}

inline std::string text(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace holdfast::protobuf
