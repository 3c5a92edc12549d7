// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "holdfast/core/error.hpp"

namespace holdfast::bridge {
namespace {

using testing::HasSubstr;

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

RawImage message_of(const cv::Mat& image, const std::string& encoding) {
  return {1,
          static_cast<std::uint32_t>(image.cols),
          static_cast<std::uint32_t>(image.rows),
          encoding,
          false,
          image.step[0],
          image.data,
          image.step[0] * static_cast<std::size_t>(image.rows)};
}

TEST(Conversions, ColourOfEveryEncodingIsBlueGreenRedInMemoryOfItsOwn) {
  cv::Mat rgb(2, 3, CV_8UC3, cv::Scalar(10, 20, 30));
  const cv::Mat converted = colour_of(message_of(rgb, "rgb8"));
  EXPECT_EQ(converted.at<cv::Vec3b>(1, 2), cv::Vec3b(30, 20, 10));
  const cv::Mat copied = colour_of(message_of(rgb, "bgr8"));
  EXPECT_EQ(copied.at<cv::Vec3b>(1, 2), cv::Vec3b(10, 20, 30));
  rgb.setTo(0);  // the middleware takes its memory back
  EXPECT_EQ(copied.at<cv::Vec3b>(1, 2), cv::Vec3b(10, 20, 30));
  const cv::Mat rgba(1, 1, CV_8UC4, cv::Scalar(1, 2, 3, 4));
  EXPECT_EQ(colour_of(message_of(rgba, "rgba8")).at<cv::Vec3b>(0, 0), cv::Vec3b(3, 2, 1));
  const cv::Mat grey(1, 1, CV_8UC1, cv::Scalar(9));
  EXPECT_EQ(colour_of(message_of(grey, "mono8")).at<cv::Vec3b>(0, 0), cv::Vec3b(9, 9, 9));
}

TEST(Conversions, DepthIsInMetresAndHasNoNumbersThatAreNone) {
  const cv::Mat millimetres = (cv::Mat_<std::uint16_t>(1, 2) << 1500, 0);
  const cv::Mat depth = depth_of(message_of(millimetres, "16UC1"), 1000);
  EXPECT_EQ(depth.type(), CV_32FC1);
  EXPECT_FLOAT_EQ(depth.at<float>(0, 0), 1.5F);
  EXPECT_EQ(depth.at<float>(0, 1), 0.0F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat metres = (cv::Mat_<float>(1, 4) << 2.5F, nan, -1.0F, std::numeric_limits<float>::infinity());
  const cv::Mat cleaned = depth_of(message_of(metres, "32FC1"), 1000);
  EXPECT_FLOAT_EQ(cleaned.at<float>(0, 0), 2.5F);
  for (int i = 1; i < 4; ++i) EXPECT_EQ(cleaned.at<float>(0, i), 0.0F) << i;
}

TEST(Conversions, CompressedImages) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", cv::Mat(2, 2, CV_16UC1, cv::Scalar(2500)), png);
  EXPECT_FLOAT_EQ(depth_of({1, "16UC1; png", png.data(), png.size()}, 1000).at<float>(1, 1), 2.5F);
  std::vector<std::uint8_t> with_settings(12, 0);
  with_settings.insert(with_settings.end(), png.begin(), png.end());
  EXPECT_FLOAT_EQ(
      depth_of({1, "16UC1; compressedDepth png", with_settings.data(), with_settings.size()}, 1000).at<float>(0, 0),
      2.5F);
  cv::imencode(".png", cv::Mat(2, 2, CV_8UC3, cv::Scalar(1, 2, 3)), png);
  EXPECT_EQ(colour_of({1, "png", png.data(), png.size()}).at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
  EXPECT_THAT(error_of([&] { colour_of(CompressedImage{1, "jpeg", png.data(), 5}); }), HasSubstr("cannot be decoded"));
  EXPECT_THAT(error_of([&] { colour_of(CompressedImage{1, "jpeg", nullptr, 0}); }), HasSubstr("cannot be decoded"));
  EXPECT_THAT(error_of([&] {
                depth_of(CompressedImage{1, "32FC1; compressedDepth png", png.data(), png.size()}, 1);
              }),
              HasSubstr("republish it as raw"));
}

TEST(Conversions, MessagesThatLieAboutTheirSizeAreRefused) {
  const cv::Mat image(4, 4, CV_8UC3, cv::Scalar::all(1));
  RawImage message = message_of(image, "rgb8");
  message.size -= 1;
  EXPECT_THAT(error_of([&] { colour_of(message); }), HasSubstr("47 bytes in rows of 12"));
  message = message_of(image, "rgb8");
  message.step = 11;
  EXPECT_THAT(error_of([&] { colour_of(message); }), HasSubstr("has rows of 12"));
  message = message_of(image, "rgb8");
  message.width = 1U << 31;
  EXPECT_THAT(error_of([&] { colour_of(message); }), HasSubstr("expected 1 to 32768"));
  message = message_of(image, "bayer_rggb8");
  EXPECT_THAT(error_of([&] { colour_of(message); }), HasSubstr("expected one of rgb8, bgr8"));
  message = message_of(cv::Mat(2, 2, CV_16UC1), "16UC1");
  message.is_big_endian = true;
  EXPECT_THAT(error_of([&] { depth_of(message, 1000); }), HasSubstr("order of another processor"));
}

CameraInfo info() {
  CameraInfo info;
  info.width = 640, info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, -0.2, 0.001, 0.002, 0.05};
  info.K = {520, 0, 320, 0, 521, 240, 0, 0, 1};
  info.P = {500, 0, 318, -50, 0, 500, 238, 0, 0, 0, 1, 0};
  return info;
}

TEST(Conversions, CameraInfo) {
  const Camera raw = camera_of(info(), false);
  EXPECT_EQ(raw.width, 640);
  EXPECT_EQ(raw.fx, 520);
  EXPECT_EQ(raw.fy, 521);
  EXPECT_EQ(raw.cx, 320);
  EXPECT_EQ(raw.cy, 240);
  EXPECT_EQ(raw.distortion.k1, 0.1);
  EXPECT_EQ(raw.distortion.p2, 0.002);
  EXPECT_EQ(raw.distortion.k3, 0.05);
  const Camera rectified = camera_of(info(), true);
  EXPECT_EQ(rectified.fx, 500);
  EXPECT_EQ(rectified.cy, 238);
  EXPECT_TRUE(rectified.distortion.is_zero());
  EXPECT_DOUBLE_EQ(baseline_of(info()).value(), 0.1);
  CameraInfo fisheye = info();
  fisheye.distortion_model = "equidistant";
  fisheye.D = {0.01, 0.001, 0, 0};
  EXPECT_EQ(camera_of(fisheye, false).distortion.lens, Lens::fisheye);
  EXPECT_EQ(camera_of(fisheye, false).distortion.k2, 0.001);
}

TEST(Conversions, CameraInfoThatCannotBeUsed) {
  CameraInfo uncalibrated = info();
  uncalibrated.K = {};
  EXPECT_THAT(error_of([&] { camera_of(uncalibrated, false); }), HasSubstr("calibrate the camera"));
  CameraInfo binned = info();
  binned.binning_x = 2;
  EXPECT_THAT(error_of([&] { camera_of(binned, false); }), HasSubstr("binning"));
  CameraInfo unknown = info();
  unknown.distortion_model = "thin_prism";
  EXPECT_THAT(error_of([&] { camera_of(unknown, false); }), HasSubstr("thin_prism"));
  EXPECT_EQ(baseline_of(CameraInfo()), std::nullopt);
}

TEST(Conversions, AnotherCameraThanTheConfiguredOneIsNoticed) {
  const Camera camera = camera_of(info(), false);
  Camera other = camera;
  other.fx = 525;
  EXPECT_EQ(difference_of(camera, other), "");
  other.fx = 610;
  EXPECT_THAT(difference_of(camera, other), HasSubstr("camera: auto"));
}

}  // namespace
}  // namespace holdfast::bridge
