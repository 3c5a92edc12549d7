// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>

namespace holdfast {

/// Eight words of 16 bits, with which compilers compute at once on every processor.
using EightWords = std::int16_t __attribute__((vector_size(16)));

inline EightWords words_at(const std::int16_t* values) {
  EightWords result;
  std::memcpy(&result, values, sizeof result);
  return result;
}

/// Eight neighbouring pixels.
inline EightWords pixels_at(const std::uint8_t* pixels) {
  using EightBytes = std::uint8_t __attribute__((vector_size(8)));
  EightBytes bytes;
  std::memcpy(&bytes, pixels, sizeof bytes);
  return __builtin_convertvector(bytes, EightWords);
}

inline EightWords absolute(EightWords values) { return values < 0 ? -values : values; }

}  // namespace holdfast
