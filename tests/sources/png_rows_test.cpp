// SPDX-License-Identifier: BSD-3-Clause
#include "png_rows.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/image_files/image_structure.hpp"

namespace holdfast {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// A chunk of a PNG file with its checksum (ISO/IEC 15948, annex D).
void append_chunk(Bytes& file, const std::string& name, const Bytes& data) {
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
Bytes stored(const Bytes& data) {
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

struct Header {
  int width = 1, height = 1;
  std::uint8_t bits = 16, colour_type = 0, interlaced = 0;
};

Bytes png(const Header& header, const Bytes& filtered_rows, const std::string& extra_chunk = "") {
  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes data;
  append(data, static_cast<std::uint32_t>(header.width));
  append(data, static_cast<std::uint32_t>(header.height));
  data.insert(data.end(), {header.bits, header.colour_type, 0, 0, header.interlaced});
  append_chunk(file, "IHDR", data);
  if (!extra_chunk.empty()) append_chunk(file, extra_chunk, Bytes(6, 0));
  const Bytes stream = stored(filtered_rows);
  const auto middle = stream.begin() + static_cast<std::ptrdiff_t>(stream.size() / 2);
  append_chunk(file, "IDAT", Bytes(stream.begin(), middle));
  append_chunk(file, "IDAT", Bytes(middle, stream.end()));
  append_chunk(file, "IEND", {});
  return file;
}

/// Filtered rows of arbitrary bytes: any of them is an image.
Bytes any_rows(Random& random, const Header& header, int bytes_per_pixel, std::uint32_t filters) {
  Bytes rows;
  for (int y = 0; y < header.height; ++y) {
    rows.push_back(static_cast<std::uint8_t>(filters == 5 ? random.below(5) : filters));
    const std::uint32_t range = random.below(2) == 0 ? 256 : 4;
    for (int x = 0; x < header.width * bytes_per_pixel; ++x)
      rows.push_back(static_cast<std::uint8_t>(random.below(range)));
  }
  return rows;
}

#if defined(HOLDFAST_LIBDEFLATE)

TEST(PngRows, GivesWhatTheDecodingLibraryGives) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const bool is_grey = i % 2 == 0;
    Header header{.width = 1 + static_cast<int>(random.below(40)), .height = 1 + static_cast<int>(random.below(9))};
    if (i == 0) header.width = header.height = 300;  // more than one block
    if (!is_grey) {
      header.bits = 8;
      header.colour_type = 2;
    }
    const int bytes_per_pixel = is_grey ? 2 : 3;
    const Bytes file = png(header, any_rows(random, header, bytes_per_pixel, static_cast<std::uint32_t>(i / 2 % 6)));
    ASSERT_EQ(examine_image(file).problem, "");
    PngRows rows;
    ASSERT_TRUE(rows.decode(file)) << i;
    EXPECT_EQ(rows.width(), header.width);
    EXPECT_EQ(rows.height(), header.height);
    EXPECT_EQ(rows.bytes_per_pixel(), bytes_per_pixel);
    const cv::Mat expected = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    ASSERT_EQ(expected.type(), is_grey ? CV_16UC1 : CV_8UC3);
    for (int y = 0; y < header.height; ++y)
      for (int x = 0; x < header.width; ++x) {
        const std::uint8_t* pixel = rows.row(y) + bytes_per_pixel * x;
        if (is_grey)
          ASSERT_EQ(pixel[0] << 8 | pixel[1], expected.at<std::uint16_t>(y, x)) << i << ": " << x << ", " << y;
        else
          ASSERT_EQ(cv::Vec3b(pixel[2], pixel[1], pixel[0]), expected.at<cv::Vec3b>(y, x))
              << i << ": " << x << ", " << y;
      }
  }
}

#endif

TEST(PngRows, LeavesOtherFilesToAnotherDecoder) {
  Random random(4);
  PngRows rows;
  const Header grey{.width = 5, .height = 4};
  const Bytes filtered = any_rows(random, grey, 2, 4);
  const auto decodes = [&](Header header, const Bytes& data, const std::string& chunk = "") {
    return rows.decode(png(header, data, chunk));
  };
#if defined(HOLDFAST_LIBDEFLATE)
  EXPECT_TRUE(decodes(grey, filtered));
#else
  EXPECT_FALSE(decodes(grey, filtered));
#endif
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8}, any_rows(random, grey, 1, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8, .colour_type = 3}, any_rows(random, grey, 1, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8, .colour_type = 6}, any_rows(random, grey, 4, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .colour_type = 2}, any_rows(random, grey, 6, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .interlaced = 1}, filtered));
  EXPECT_FALSE(decodes(grey, filtered, "tRNS"));
  // Too few and too many pixels, a filter that does not exist, a wrong checksum of zlib, a size out of proportion.
  EXPECT_FALSE(decodes({.width = 5, .height = 5}, filtered));
  EXPECT_FALSE(decodes({.width = 5, .height = 3}, filtered));
  Bytes bad_filter = filtered;
  bad_filter[11] = 5;
  EXPECT_FALSE(decodes(grey, bad_filter));
  Bytes damaged = png(grey, filtered);
  damaged[damaged.size() - 17] ^= 1;
  EXPECT_FALSE(rows.decode(damaged));
  EXPECT_FALSE(decodes({.width = 32768, .height = 32768}, filtered));
}

}  // namespace
}  // namespace holdfast
