// SPDX-License-Identifier: BSD-3-Clause
#include "crc32c.hpp"

#include <array>

namespace holdfast::map_io {

namespace {

/// tables[k][b]: what byte b does to the remainder when k zero bytes follow it.
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1U) != 0 ? 0x82F63B78U : 0U);
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFFU];
  return tables;
}

constexpr Tables tables = make_tables();

std::uint32_t little_endian(const unsigned char* bytes) {
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8 | static_cast<std::uint32_t>(bytes[2]) << 16 |
         static_cast<std::uint32_t>(bytes[3]) << 24;
}

}  // namespace

std::uint32_t crc32c(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (; size >= 8; size -= 8, bytes += 8) {  // eight bytes at a time: independent look-ups
    const std::uint32_t low = remainder ^ little_endian(bytes), high = little_endian(bytes + 4);
    remainder = tables[7][low & 0xFFU] ^ tables[6][(low >> 8) & 0xFFU] ^ tables[5][(low >> 16) & 0xFFU] ^
                tables[4][low >> 24] ^ tables[3][high & 0xFFU] ^ tables[2][(high >> 8) & 0xFFU] ^
                tables[1][(high >> 16) & 0xFFU] ^ tables[0][high >> 24];
  }
  for (; size > 0; --size, ++bytes) remainder = (remainder >> 8) ^ tables[0][(remainder ^ *bytes) & 0xFFU];
  return ~remainder;
}

}  // namespace holdfast::map_io
