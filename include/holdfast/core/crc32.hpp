// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace holdfast {

namespace detail {

/// Entry [k][b] is the remainder of byte b followed by k zero bytes.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr CrcTables make_crc_tables(std::uint32_t reflected_polynomial) {
  CrcTables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit)
      remainder = (remainder >> 1) ^ ((remainder & 1U) != 0 ? reflected_polynomial : 0U);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFFU];
  return tables;
}

template <std::uint32_t reflected_polynomial>
inline constexpr CrcTables crc_tables = make_crc_tables(reflected_polynomial);

}  // namespace detail

/// Cyclic redundancy check of 32 bits with reflected polynomial and inverted initial and final value. add() may be
/// called repeatedly; it processes eight bytes at a time by table look-up (slicing-by-8).
template <std::uint32_t reflected_polynomial>
class ReflectedCrc32 {
 public:
  ReflectedCrc32& add(std::span<const std::uint8_t> bytes) {
    constexpr const detail::CrcTables& tables = detail::crc_tables<reflected_polynomial>;
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
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
  static std::uint32_t little_endian(const std::uint8_t* bytes) {
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8 | static_cast<std::uint32_t>(bytes[2]) << 16 |
           static_cast<std::uint32_t>(bytes[3]) << 24;
  }

  std::uint32_t remainder_ = 0xFFFFFFFFU;
};

/// ISO 3309 (polynomial 0x04C11DB7), used by MCAP. The value of "123456789" is 0xCBF43926.
using Crc32 = ReflectedCrc32<0xEDB88320U>;
/// CRC-32C of Castagnoli et al. 1993 (polynomial 0x1EDC6F41, RFC 3720), used by map files. The value of "123456789" is
/// 0xE3069283. Detects every burst error of up to 32 bits.
using Crc32c = ReflectedCrc32<0x82F63B78U>;

}  // namespace holdfast
