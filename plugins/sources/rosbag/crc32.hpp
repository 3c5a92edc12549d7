// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "byte_reader.hpp"

namespace holdfast::rosbag_plugin {

/// CRC-32 of ISO 3309 (polynomial 0x04C11DB7, reflected, begin and end inverted), as MCAP uses it, of bytes that come
/// in pieces; that of "123456789" is 0xCBF43926.
class Crc32 {
 public:
  Crc32& add(Bytes bytes) {
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {  // eight bytes at a time: independent look-ups
      const std::uint32_t low = remainder_ ^ little_endian(bytes.data() + i),
                          high = little_endian(bytes.data() + i + 4);
      remainder_ = tables[7][low & 0xFFU] ^ tables[6][(low >> 8) & 0xFFU] ^ tables[5][(low >> 16) & 0xFFU] ^
                   tables[4][low >> 24] ^ tables[3][high & 0xFFU] ^ tables[2][(high >> 8) & 0xFFU] ^
                   tables[1][(high >> 16) & 0xFFU] ^ tables[0][high >> 24];
    }
    for (; i < bytes.size(); ++i) remainder_ = (remainder_ >> 8) ^ tables[0][(remainder_ ^ bytes[i]) & 0xFFU];
    return *this;
  }
  std::uint32_t value() const { return ~remainder_; }

 private:
  /// tables[k][b]: what byte b does to the remainder when k zero bytes follow it.
  using Tables = std::array<std::array<std::uint32_t, 256>, 8>;
  static constexpr Tables make_tables() {
    Tables result{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint32_t remainder = byte;
      for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1U) != 0 ? 0xEDB88320U : 0U);
      result[0][byte] = remainder;
    }
    for (std::size_t k = 1; k < 8; ++k)
      for (std::size_t byte = 0; byte < 256; ++byte)
        result[k][byte] = (result[k - 1][byte] >> 8) ^ result[0][result[k - 1][byte] & 0xFFU];
    return result;
  }
  static std::uint32_t little_endian(const std::uint8_t* bytes) {
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8 | static_cast<std::uint32_t>(bytes[2]) << 16 |
           static_cast<std::uint32_t>(bytes[3]) << 24;
  }

  static const Tables tables;
  std::uint32_t remainder_ = 0xFFFFFFFFU;
};

inline const Crc32::Tables Crc32::tables = Crc32::make_tables();

}  // namespace holdfast::rosbag_plugin
