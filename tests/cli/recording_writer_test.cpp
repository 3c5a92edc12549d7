// SPDX-License-Identifier: BSD-3-Clause
#include "recording_writer.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "cli/program.hpp"
#include "depth_units.hpp"
#include "holdfast/image_files/image_structure.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "png_encoder.hpp"

namespace holdfast {
namespace {

/// Depth that a sensor of so many units to the metre can give, all of its numbers.
cv::Mat all_depths(double factor) {
  cv::Mat units(256, 256, CV_16UC1);
  for (int i = 0; i < 65536; ++i) units.at<std::uint16_t>(i / 256, i % 256) = static_cast<std::uint16_t>(i);
  return depth_of_units(units, factor);
}

SensorFrame frame_of(double timestamp, const cv::Mat& depth) {
  SensorFrame frame;
  frame.timestamp = timestamp;
  frame.colour = cv::Mat(depth.size(), CV_8UC3, cv::Scalar(1, 2, 3));
  frame.depth = depth;
  return frame;
}

TEST(DepthUnitsTest, EveryNumberOfASensorComesBack) {
  for (const double factor : {256.0, 1000.0, 4000.0, 5000.0, 10000.0, 1234.567}) {
    SCOPED_TRACE(factor);
    const cv::Mat depth = all_depths(factor);
    EXPECT_TRUE(is_same_depth(depth_of_units(to_depth_units(depth, factor), factor), depth));
  }
}

TEST(DepthUnitsTest, TheFirstExactFactorIsTaken) {
  const std::vector<double> factors = {1000.0, 5000.0};
  EXPECT_EQ(exact_depth_factor(all_depths(1000.0), factors), 1000.0);
  EXPECT_EQ(exact_depth_factor(all_depths(5000.0), factors), 5000.0);
  EXPECT_EQ(exact_depth_factor(all_depths(4000.0), factors), 0.0);
  EXPECT_EQ(exact_depth_factor(all_depths(4000.0), {4000.0, 1000.0}), 4000.0);
}

TEST(PngEncoderTest, ImagesComeBackAsTheyWere) {
  cv::RNG random(7);
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(37, 23), cv::Size(640, 480)})
    for (const int type : {CV_8UC3, CV_16UC1}) {
      cv::Mat image(size, type);
      random.fill(image, cv::RNG::UNIFORM, 0, 65536, true);
      image.rowRange(0, image.rows / 2).setTo(type == CV_8UC3 ? cv::Scalar(1, 2, 3) : cv::Scalar(300));
      const std::string bytes = encode_png(image);
      EXPECT_EQ(examine_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}).problem, "");
      const cv::Mat decoded = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(decoded.type(), type);
      EXPECT_EQ(cv::norm(decoded, image, cv::NORM_INF), 0.0);
    }
}

class RecordingWriterTest : public testing::Test {
 protected:
  RecordingWriter writer(std::vector<double> factors) const {
    return {program_.path("recording"), {.depth_factors = std::move(factors)}};
  }
  /// Depth images that were written, in the order of their stamps.
  cv::Mat depth(const char* stamp) const {
    return cv::imread((program_.path("recording") / "depth" / (std::string(stamp) + ".png")).string(),
                      cv::IMREAD_UNCHANGED);
  }
  test::Program program_;
};

TEST_F(RecordingWriterTest, DepthInMillimetresIsExactToTheLastNumber) {
  RecordingWriter recording = writer({1000.0, 5000.0});
  // A first image without depth says nothing.
  for (const auto& [stamp, image] :
       {std::pair{1.0, cv::Mat(cv::Mat::zeros(256, 256, CV_32FC1))}, {2.0, all_depths(1000.0)}}) {
    const SensorFrame frame = frame_of(stamp, image);
    const SensorFrame recorded = recording.as_recorded(frame);
    EXPECT_EQ(recorded.depth.data, frame.depth.data) << "nothing changes";
    recording.add(recorded);
  }
  recording.finish({});
  EXPECT_EQ(recording.depth_factor(), 1000.0);
  EXPECT_EQ(recording.rounded_frames(), 0u);
  EXPECT_EQ(cv::countNonZero(depth("1.000000")), 0);
  const cv::Mat units = depth("2.000000");
  for (int i = 0; i < 65536; ++i) ASSERT_EQ(units.at<std::uint16_t>(i / 256, i % 256), i);
}

TEST_F(RecordingWriterTest, OtherDepthIsRoundedAndCounted) {
  RecordingWriter recording = writer({1000.0, 5000.0});
  cv::Mat depth(4, 4, CV_32FC1, cv::Scalar(1.23456));
  depth.at<float>(0, 0) = 14.0F;
  const SensorFrame recorded = recording.as_recorded(frame_of(1.0, depth));
  EXPECT_EQ(recording.depth_factor(), 5000.0);
  EXPECT_EQ(recording.rounded_frames(), 1u);
  EXPECT_EQ(recorded.depth.at<float>(1, 1), 6173.0F / 5000.0F);
  EXPECT_EQ(recorded.depth.at<float>(0, 0), 0.0F) << "too far for 16 bits";
}

TEST_F(RecordingWriterTest, InertialMeasurementsAreWrittenOnce) {
  RecordingWriter recording = writer({1000.0});
  SensorFrame first = frame_of(1.0, all_depths(1000.0)), second = frame_of(1.1, all_depths(1000.0));
  const ImuSample a{0.995, {1, 2, 3}, {4, 5, 9.8}}, b{1.05, {0, 0, 1}, {0, 0, 9.8}}, c{1.1, {0, 0, 2}, {0, 0, 9.7}};
  first.imu = {a};
  second.imu = {a, b, c};
  recording.add(first);
  recording.add(second);
  recording.finish({});
  EXPECT_EQ(read_imu_samples(find_imu_file(program_.path("recording"), {})), (std::vector<ImuSample>{a, b, c}));
}

}  // namespace
}  // namespace holdfast
