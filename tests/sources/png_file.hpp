// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"

/// PNG files made by hand, to have those in the tests that no encoder writes.
namespace holdfast::test {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// A chunk of a PNG file with its checksum (ISO/IEC 15948, annex D).
inline void append_chunk(Bytes& file, const std::string& name, const Bytes& data) {
  append(file, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = file.size();
  file.insert(file.end(), name.begin(), name.end());
  file.insert(file.end(), data.begin(), data.end());
  std::uint32_t checksum = 0xffffffffU;
  for (std::size_t i = begin; i < file.size(); ++i) {
    checksum ^= file[i];
    for (int bit = 0; bit < 8; ++bit) checksum = (checksum & 1U) != 0 ? 0xedb88320U ^ (checksum >> 1) : checksum >> 1;
  }
  append(file, ~checksum);
}

/// A zlib stream without compression (RFC 1950 and 1951).
inline Bytes stored(const Bytes& data) {
  constexpr std::size_t block = 65535;
  Bytes stream{0x78, 0x01};
  for (std::size_t at = 0; at < data.size(); at += block) {
    const std::size_t size = std::min(block, data.size() - at);
    const auto low = static_cast<std::uint8_t>(size), high = static_cast<std::uint8_t>(size >> 8);
    const std::uint8_t is_last = at + size == data.size() ? 1 : 0;
    stream.insert(stream.end(),
                  {is_last, low, high, static_cast<std::uint8_t>(~low), static_cast<std::uint8_t>(~high)});
    stream.insert(stream.end(), data.begin() + static_cast<std::ptrdiff_t>(at),
                  data.begin() + static_cast<std::ptrdiff_t>(at + size));
  }
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : data) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  append(stream, b << 16 | a);
  return stream;
}

/// What the test files differ in.
struct PngHeader {
  int width = 1, height = 1;
  std::uint8_t bits = 16, colour_type = 0, interlaced = 0;
};

/// A file whose image data are this stream, in two chunks. `extra_chunk`: a chunk of six zeros before them.
inline Bytes png_of_stream(const PngHeader& header, const Bytes& stream, const std::string& extra_chunk = "") {
  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes data;
  append(data, static_cast<std::uint32_t>(header.width));
  append(data, static_cast<std::uint32_t>(header.height));
  data.insert(data.end(), {header.bits, header.colour_type, 0, 0, header.interlaced});
  append_chunk(file, "IHDR", data);
  if (!extra_chunk.empty()) append_chunk(file, extra_chunk, Bytes(6, 0));
  const auto middle = stream.begin() + static_cast<std::ptrdiff_t>(stream.size() / 2);
  append_chunk(file, "IDAT", Bytes(stream.begin(), middle));
  append_chunk(file, "IDAT", Bytes(middle, stream.end()));
  append_chunk(file, "IEND", {});
  return file;
}

inline Bytes png(const PngHeader& header, const Bytes& filtered_rows, const std::string& extra_chunk = "") {
  return png_of_stream(header, stored(filtered_rows), extra_chunk);
}

/// Filtered rows of arbitrary bytes: any of them is an image.
inline Bytes any_rows(Random& random, const PngHeader& header, int bytes_per_pixel, std::uint32_t filters) {
  Bytes rows;
  for (int y = 0; y < header.height; ++y) {
    rows.push_back(static_cast<std::uint8_t>(filters == 5 ? random.below(5) : filters));
    const std::uint32_t range = random.below(2) == 0 ? 256 : 4;
    for (int x = 0; x < header.width * bytes_per_pixel; ++x)
      rows.push_back(static_cast<std::uint8_t>(random.below(range)));
  }
  return rows;
}

}  // namespace holdfast::test
