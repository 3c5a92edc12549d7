// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_decoder.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "sources/png_file.hpp"
#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class ImageDecoderTest : public testing::Test {
 protected:
  std::filesystem::path file(const char* name) const { return folder_.path() / name; }
  std::string colour_error(const char* name) {
    return input_error([&] { decoder_.read_colour(file(name)); });
  }
  std::string depth_error(const char* name) {
    return input_error([&] { decoder_.read_depth(file(name), 5000.0); });
  }

  test::TemporaryFolder folder_;
  ImageDecoder decoder_;
};

TEST_F(ImageDecoderTest, ReadsTheColoursThatWereWritten) {
  const cv::Mat original = test::colour_image(3);
  folder_.write_image("a.png", original);
  const cv::Mat image = decoder_.read_colour(file("a.png"));
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(cv::norm(image, original, cv::NORM_INF), 0.0);
}

TEST_F(ImageDecoderTest, ReadsJpegAsTheDecodingLibraryDoes) {
  folder_.write_image("a.jpg", test::colour_image(3));
  const cv::Mat expected = cv::imread(file("a.jpg").string(), cv::IMREAD_COLOR);
  EXPECT_EQ(cv::norm(decoder_.read_colour(file("a.jpg")), expected, cv::NORM_INF), 0.0);
  cv::imwrite(file("progressive.jpg").string(), test::colour_image(3), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_EQ(decoder_.read_colour(file("progressive.jpg")).cols, test::recording_width);
}

TEST_F(ImageDecoderTest, DepthIsTheQuotientExactly) {
  cv::Mat original(256, 256, CV_16UC1);
  for (int value = 0; value < 65536; ++value)
    original.at<std::uint16_t>(value / 256, value % 256) = static_cast<std::uint16_t>(value);
  folder_.write_image("d.png", original);
  for (const double factor : {5000.0, 1000.0, 4999.5, 5000.1}) {
    const cv::Mat depth = decoder_.read_depth(file("d.png"), factor);
    ASSERT_EQ(depth.type(), CV_32FC1);
    EXPECT_EQ(depth.at<float>(255, 255), 0.0F) << "65535 is no measurement";
    for (int value = 0; value < 65535; ++value)
      ASSERT_EQ(depth.at<float>(value / 256, value % 256), static_cast<float>(value / factor)) << value;
  }
}

TEST_F(ImageDecoderTest, AnImageIsNotOverwrittenByTheNext) {
  folder_.write_image("1.png", test::depth_image(1));
  folder_.write_image("2.png", test::depth_image(2));
  const cv::Mat first = decoder_.read_depth(file("1.png"), 1.0);
  decoder_.read_depth(file("2.png"), 1.0);
  EXPECT_EQ(first.at<float>(1, 1), 165.0f);
}

TEST_F(ImageDecoderTest, MissingAndUnreadableFiles) {
  EXPECT_THAT(colour_error("none.png"), AllOf(StartsWith(file("none.png").string()), HasSubstr("is missing")));
  std::filesystem::create_directory(file("folder.png"));
  EXPECT_THAT(colour_error("folder.png"), HasSubstr("found a folder"));
  folder_.write("empty.png", "");
  EXPECT_THAT(colour_error("empty.png"), HasSubstr("is empty (0 bytes)"));
  folder_.write("text.png", "<html>404 not found</html>");
  EXPECT_THAT(colour_error("text.png"), HasSubstr("is neither a PNG nor a JPEG image"));
}

TEST_F(ImageDecoderTest, EveryTruncationIsFoundWithoutAWordFromTheLibraries) {
  folder_.write_image("c.jpg", test::colour_image(1));
  folder_.write_image("c.png", test::colour_image(1));
  folder_.write_image("d.png", test::depth_image(1));
  for (const char* name : {"c.jpg", "c.png", "d.png"}) {
    const std::string whole = folder_.read(name);
    for (std::size_t size = 8; size < whole.size(); size += size < 64 ? 1 : 13) {
      folder_.write("cut", whole.substr(0, size));
      EXPECT_THAT(name[0] == 'd' ? depth_error("cut") : colour_error("cut"),
                  HasSubstr("is truncated: it ends after " + std::to_string(size) + " bytes"))
          << name;
    }
    folder_.write("cut", whole.substr(0, whole.size() - 1));
    EXPECT_THAT(name[0] == 'd' ? depth_error("cut") : colour_error("cut"), HasSubstr("is truncated")) << name;
  }
}

TEST_F(ImageDecoderTest, BytesAfterTheEndAreAllowed) {
  for (const char* name : {"c.jpg", "c.png"}) {
    folder_.write_image(name, test::colour_image(1));
    folder_.write("longer", folder_.read(name) + std::string(37, '\0') + "tail");
    EXPECT_EQ(decoder_.read_colour(file("longer")).rows, test::recording_height);
  }
}

TEST_F(ImageDecoderTest, DamagedPngIsFoundByItsChecksum) {
  folder_.write_image("d.png", test::depth_image(1));
  std::string bytes = folder_.read("d.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  folder_.write("d.png", bytes);
  EXPECT_THAT(depth_error("d.png"), HasSubstr("is damaged: the checksum"));
}

TEST_F(ImageDecoderTest, WhatAPngSaysBesidesItsPixelsIsIgnoredInSilence) {
  const cv::Mat original = test::colour_image(1);
  folder_.write_image("c.png", original);
  std::string bytes = folder_.read("c.png");
  // A colour profile, a background and a palette of one byte, behind the header of 33 bytes, each with its checksum.
  bytes.insert(33, std::string("\0\0\0\1iCCPx\x4d\x18\x82\x31", 13) + std::string("\0\0\0\1bKGDx\xd6\xdb\xe4\x46", 13) +
                       std::string("\0\0\0\1PLTEx\x97\x96\x1b\x71", 13));
  folder_.write("c.png", bytes);
  testing::internal::CaptureStderr();
  const cv::Mat image = decoder_.read_colour(file("c.png"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(cv::norm(image, original, cv::NORM_INF), 0.0);
}

TEST_F(ImageDecoderTest, AHeaderThatDescribesNoImageIsDamage) {
  folder_.write_image("d.png", test::depth_image(1));
  std::string bytes = folder_.read("d.png");
  bytes[24] = 3;  // bits of a channel, and the checksum of such a header
  bytes.replace(29, 4, "\xf3\xf0\x12\xd2");
  folder_.write("d.png", bytes);
  EXPECT_THAT(depth_error("d.png"), HasSubstr("its header describes no kind of image"));
}

/// Known by the header: the pixels of these files are missing, which would be damage.
TEST_F(ImageDecoderTest, AnImageLargerThanACamerasIsNotDecoded) {
  const auto write = [&](int width, int height, std::uint8_t bits, std::uint8_t colour_type) {
    const test::Bytes bytes = test::png_of_stream(
        {.width = width, .height = height, .bits = bits, .colour_type = colour_type}, test::Bytes(100, 0));
    folder_.write("large.png", std::string(bytes.begin(), bytes.end()));
  };
  const auto refused = HasSubstr(
      "expected at least one pixel and at most 32768 pixels in width and height, and 100 "
      "million pixels");
  write(20000, 20000, 8, 2);
  EXPECT_THAT(colour_error("large.png"), AllOf(HasSubstr("20000x20000"), refused));
  EXPECT_THAT(input_error([&] { decoder_.read_grey(file("large.png")); }), refused);
  write(40000, 2, 8, 2);
  EXPECT_THAT(colour_error("large.png"), refused);
  write(10001, 10000, 16, 0);
  EXPECT_THAT(depth_error("large.png"), refused);
  EXPECT_THAT(input_error([&] { decoder_.read_labels(file("large.png")); }), refused);
  write(300, 300, 16, 0);
  EXPECT_THAT(depth_error("large.png"), HasSubstr("is damaged"));
}

TEST_F(ImageDecoderTest, JpegWithoutDataIsDamaged) {
  folder_.write("a.jpg", std::string("\xff\xd8\xff\xd9", 4));
  EXPECT_THAT(colour_error("a.jpg"), HasSubstr("holds no image data"));
}

#if defined(HOLDFAST_LIBJPEG)

TEST_F(ImageDecoderTest, DamagedJpegIsFoundInSilence) {
  cv::Mat noise(48, 64, CV_8UC3);
  cv::randu(noise, 0, 256);
  for (const int progressive : {0, 1}) {
    cv::imwrite(file("a.jpg").string(), noise, {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    const std::string whole = folder_.read("a.jpg");
    // A marker that restarts the coding where nothing restarts, and the end of a scan before its time.
    for (const char* marker : {"\xff\xd3", "\xff\xd9"}) {
      std::string damaged = whole;
      damaged.replace(whole.size() - 300, 2, marker);
      folder_.write("damaged.jpg", damaged);
      EXPECT_THAT(colour_error("damaged.jpg"), HasSubstr("is damaged: it cannot be decoded"));
    }
    std::string without_tables = whole;
    without_tables[whole.find("\xff\xdb") + 4] = 3;  // the number of the first quantisation table
    folder_.write("without_tables.jpg", without_tables);
    EXPECT_THAT(colour_error("without_tables.jpg"), HasSubstr("is damaged: it cannot be decoded"));
  }
}

TEST_F(ImageDecoderTest, BytesBetweenTheSegmentsOfAJpegAreAllowedInSilence) {
  folder_.write_image("a.jpg", test::colour_image(3));
  const cv::Mat expected = decoder_.read_colour(file("a.jpg"));
  std::string padded = folder_.read("a.jpg");
  padded.insert(padded.size() - 2, 3, '\0');
  folder_.write("padded.jpg", padded);
  testing::internal::CaptureStderr();
  const cv::Mat image = decoder_.read_colour(file("padded.jpg"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0.0);
}

#endif

TEST_F(ImageDecoderTest, ColourOfAnotherKindIsNotConverted) {
  folder_.write_image("grey.jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(7)));
  EXPECT_THAT(colour_error("grey.jpg"),
              AllOf(HasSubstr("64x48, 1 channel of 8 bits"), HasSubstr("expected a colour image")));
  folder_.write_image("alpha.png", cv::Mat(48, 64, CV_8UC4, cv::Scalar::all(7)));
  EXPECT_THAT(colour_error("alpha.png"), HasSubstr("4 channels of 8 bits"));
  folder_.write_image("deep.png", cv::Mat(48, 64, CV_16UC3, cv::Scalar::all(7)));
  EXPECT_THAT(colour_error("deep.png"), HasSubstr("3 channels of 16 bits"));
}

TEST_F(ImageDecoderTest, DepthOfAnotherKindIsNotConverted) {
  folder_.write_image("grey.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(7)));
  EXPECT_THAT(depth_error("grey.png"), AllOf(HasSubstr("1 channel of 8 bits"), HasSubstr("1 channel of 16 bits")));
  folder_.write_image("colour.png", cv::Mat(48, 64, CV_16UC3, cv::Scalar::all(7)));
  EXPECT_THAT(depth_error("colour.png"), HasSubstr("3 channels of 16 bits"));
  folder_.write_image("grey.jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(7)));
  EXPECT_THAT(depth_error("grey.jpg"), HasSubstr("is a JPEG image"));
}

}  // namespace
}  // namespace holdfast
