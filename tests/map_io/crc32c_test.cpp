// SPDX-License-Identifier: BSD-3-Clause
#include "crc32c.hpp"

#include <gtest/gtest.h>

#include <string>

namespace holdfast::map_io {
namespace {

std::uint32_t checksum(const std::string& bytes) { return crc32c(bytes.data(), bytes.size()); }

TEST(Crc32c, KnownValues) {
  // RFC 3720, appendix B.4, and the check value of the catalogue of CRCs.
  EXPECT_EQ(checksum(""), 0U);
  EXPECT_EQ(checksum("123456789"), 0xE3069283U);
  EXPECT_EQ(checksum(std::string(32, '\0')), 0x8A9136AAU);
  EXPECT_EQ(checksum(std::string(32, '\xFF')), 0x62A8AB43U);
  std::string rising;
  for (int i = 0; i < 32; ++i) rising += static_cast<char>(i);
  EXPECT_EQ(checksum(rising), 0x46DD794EU);
}

TEST(Crc32c, EveryLengthAgreesWithBitByBit) {
  std::string bytes;
  for (int length = 0; length < 40; ++length) {
    std::uint32_t remainder = 0xFFFFFFFFU;
    for (const char byte : bytes) {
      remainder ^= static_cast<unsigned char>(byte);
      for (int bit = 0; bit < 8; ++bit)
        remainder = (remainder & 1U) != 0 ? (remainder >> 1) ^ 0x82F63B78U : remainder >> 1;
    }
    EXPECT_EQ(checksum(bytes), ~remainder) << length;
    bytes += static_cast<char>(37 * length + 11);
  }
}

}  // namespace
}  // namespace holdfast::map_io
