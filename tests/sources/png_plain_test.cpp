// SPDX-License-Identifier: BSD-3-Clause
#include "png_plain.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/image_structure.hpp"
#include "sources/png_file.hpp"
#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::any_rows;
using test::Bytes;
using test::png;
using test::png_of_stream;
using test::PngHeader;
using testing::HasSubstr;

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

TEST(PlainPng, HasTheSamePixels) {
  struct Kind {
    std::uint8_t bits, colour_type;
    int bits_per_pixel;
  };
  constexpr Kind kinds[] = {{1, 0, 1},   {2, 0, 2},  {4, 0, 4},   {8, 0, 8},  {16, 0, 16}, {8, 2, 24},
                            {16, 2, 48}, {8, 4, 16}, {16, 4, 32}, {8, 6, 32}, {16, 6, 64}, {1, 3, 1}};
  Random random(5);
  for (const Kind& kind : kinds)
    for (const int width : {1, 2, 7, 33}) {
      PngHeader header{.width = width, .height = 5, .bits = kind.bits, .colour_type = kind.colour_type};
      if (kind.bits_per_pixel % 8 != 0 && width % 8 != 0) header.width = 8 * width;  // whole bytes
      const PngHeader bytes_only{.width = header.width * kind.bits_per_pixel / 8, .height = 5};
      const Bytes file = png(header, any_rows(random, bytes_only, 1, 5), kind.colour_type == 3 ? "PLTE" : "");
      ASSERT_EQ(examine_image(file).problem, "");
      const auto plain = plain_png(file);
      ASSERT_TRUE(plain) << int{kind.colour_type} << ", " << int{kind.bits} << " bits, width " << width;
      const cv::Mat expected = cv::imdecode(file, cv::IMREAD_UNCHANGED);
      const cv::Mat pixels = cv::imdecode(*plain, cv::IMREAD_UNCHANGED);
      ASSERT_FALSE(expected.empty());
      ASSERT_EQ(pixels.type(), expected.type());
      EXPECT_EQ(cv::norm(pixels, expected, cv::NORM_INF), 0.0);
    }
}

#if defined(HOLDFAST_LIBDEFLATE)

TEST(PlainPng, KnowsTheSizesOfThePassesOfAnInterlacedImage) {
  Random random(6);
  // 3x2 pixels in three passes: the first pixel, the third pixel of the first row, the second pixel of it, and a row.
  const PngHeader header{.width = 3, .height = 2, .bits = 8, .interlaced = 1};
  Bytes rows;
  for (const int width : {1, 1, 1, 3}) {
    const Bytes row = any_rows(random, {.width = width, .height = 1}, 1, 0);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  const auto plain = plain_png(png(header, rows));
  ASSERT_TRUE(plain);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(2, 3) << rows[1], rows[5], rows[3], rows[7], rows[8], rows[9]);
  EXPECT_EQ(cv::norm(cv::imdecode(*plain, cv::IMREAD_UNCHANGED), expected, cv::NORM_INF), 0.0);
  rows.pop_back();
  EXPECT_FALSE(plain_png(png(header, rows)));
}

TEST(PlainPng, HasAnEntryOfThePaletteForEveryIndex) {
  const PngHeader header{.width = 4, .height = 1, .bits = 8, .colour_type = 3};
  const auto plain = plain_png(png(header, {0, 0, 1, 2, 255}, "PLTE"));  // of two entries
  ASSERT_TRUE(plain);
  testing::internal::CaptureStderr();
  const cv::Mat pixels = cv::imdecode(*plain, cv::IMREAD_UNCHANGED);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(cv::norm(pixels, cv::NORM_INF), 0.0);
}

TEST(PlainPng, DamageUnderARightChecksumIsFoundInSilence) {
  const test::TemporaryFolder folder;
  const auto error_of = [&](const Bytes& file) {
    folder.write("image.png", text_of(file));
    ImageDecoder decoder;
    return test::input_error([&] { decoder.read_labels(folder.path() / "image.png"); });
  };
  const PngHeader header{.width = 5, .height = 4, .bits = 8};
  Random random(7);
  const Bytes rows = any_rows(random, header, 1, 0);
  const Bytes stream = test::stored(rows);
  Bytes bad_filter = rows, short_rows = rows, long_rows = rows, bad_sum = stream;
  bad_filter[12] = 5;
  short_rows.pop_back();
  long_rows.push_back(0);
  bad_sum.back() ^= 1;
  for (const Bytes& file :
       {png(header, bad_filter), png(header, short_rows), png(header, long_rows), png_of_stream(header, bad_sum),
        png_of_stream(header, Bytes(stream.size(), 0x55)), png({.width = 9999, .height = 9999, .bits = 8}, rows)}) {
    ASSERT_EQ(examine_image(file).problem, "");
    EXPECT_THAT(error_of(file), HasSubstr("is damaged: it cannot be decoded"));
  }
}

TEST(PlainPng, DataAfterTheEndOfTheStreamAreAllowedInSilence) {
  const test::TemporaryFolder folder;
  const PngHeader header{.width = 2, .height = 1, .bits = 8};
  Bytes stream = test::stored({0, 3, 4});
  stream.insert(stream.end(), {1, 2, 3, 4, 5, 6});
  folder.write("image.png", text_of(png_of_stream(header, stream)));
  ImageDecoder decoder;
  testing::internal::CaptureStderr();
  const cv::Mat labels = decoder.read_labels(folder.path() / "image.png");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(labels.at<std::uint8_t>(0, 1), 4);
}

#endif

}  // namespace
}  // namespace holdfast
