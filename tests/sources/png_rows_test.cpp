// SPDX-License-Identifier: BSD-3-Clause
#include "png_rows.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "holdfast/image_files/image_structure.hpp"
#include "sources/png_file.hpp"

namespace holdfast {
namespace {

using test::any_rows;
using test::Bytes;
using test::png;
using test::PngHeader;

#if defined(HOLDFAST_LIBDEFLATE)

TEST(PngRows, GivesWhatTheDecodingLibraryGives) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const bool is_grey = i % 2 == 0;
    PngHeader header{.width = 1 + static_cast<int>(random.below(40)), .height = 1 + static_cast<int>(random.below(9))};
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
  const PngHeader grey{.width = 5, .height = 4};
  const Bytes filtered = any_rows(random, grey, 2, 4);
  const auto decodes = [&](PngHeader header, const Bytes& data, const std::string& chunk = "") {
    return rows.decode(png(header, data, chunk));
  };
#if defined(HOLDFAST_LIBDEFLATE)
  EXPECT_TRUE(decodes(grey, filtered));
  EXPECT_TRUE(decodes(grey, filtered, "tEXt"));
#else
  EXPECT_FALSE(decodes(grey, filtered));
#endif
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8}, any_rows(random, grey, 1, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8, .colour_type = 3}, any_rows(random, grey, 1, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .bits = 8, .colour_type = 6}, any_rows(random, grey, 4, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .colour_type = 2}, any_rows(random, grey, 6, 0)));
  EXPECT_FALSE(decodes({.width = 5, .height = 4, .interlaced = 1}, filtered));
  EXPECT_FALSE(decodes(grey, filtered, "tRNS"));
  EXPECT_FALSE(decodes(grey, filtered, "IHDR"));
  EXPECT_FALSE(decodes(grey, filtered, "IDAT"));
  EXPECT_FALSE(decodes(grey, filtered, "CgBI"));
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
