// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

constexpr const char* calibration =
    "P0: 50 0 32 0 0 50 24 0 0 0 1 0\n"
    "P1: 50 0 32 -25 0 50 24 0 0 0 1 0\n"
    "P2: 50 0 32 3 0 50 24 0 0 0 1 0\n"
    "P3: 50 0 32 -22 0 50 24 0 0 0 1 0\n"
    "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n";

/// A sequence of three frames, one metre forward in each.
class KittiTest : public ::testing::Test {
 protected:
  KittiTest() {
    for (const char* images : {"image_0", "image_1"})
      for (int i = 0; i < 3; ++i) {
        cv::Mat grey;
        cv::extractChannel(test::colour_image(i), grey, images[6] == '0' ? 0 : 1);
        folder_.write_image(std::string(sequence) + images + "/00000" + std::to_string(i) + ".png", grey);
      }
    folder_.write(std::string(sequence) + "calib.txt", calibration);
    folder_.write(std::string(sequence) + "times.txt", "0.0\n0.1\n0.21\n");
    folder_.write("poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) {
    values["path"] = (folder_.path() / "sequences/07").string();
    return test::make_source("kitti", values);
  }
  void copy_as_colour() {
    for (int i = 0; i < 3; ++i)
      for (const char* images : {"image_2", "image_3"})
        folder_.write_image(std::string(sequence) + images + "/00000" + std::to_string(i) + ".png",
                            test::colour_image(i));
  }

  static constexpr const char* sequence = "sequences/07/";
  test::TemporaryFolder folder_;
};

TEST_F(KittiTest, ReadsPairsCameraStampsAndTruth) {
  const auto source = open();
  const SourceDescription description = source->describe();
  EXPECT_EQ(description.name, "07");
  EXPECT_FALSE(description.has_depth);
  EXPECT_TRUE(description.has_right);
  EXPECT_EQ(description.frame_count, 3U);
  ASSERT_TRUE(description.camera.has_value());
  EXPECT_EQ(description.camera->width, test::recording_width);
  EXPECT_EQ(description.camera->fx, 50.0);
  EXPECT_DOUBLE_EQ(description.camera->baseline, 0.5);
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].timestamp, 0.21);
  EXPECT_EQ(frames[2].colour.type(), CV_8UC3);
  EXPECT_EQ(frames[2].right.type(), CV_8UC1);
  const cv::Mat expected = test::colour_image(2);
  EXPECT_EQ(frames[2].colour.at<cv::Vec3b>(5, 7), cv::Vec3b::all(expected.at<cv::Vec3b>(5, 7)[0]));
  EXPECT_EQ(frames[2].right.at<std::uint8_t>(5, 7), expected.at<cv::Vec3b>(5, 7)[1]);
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 3U);
  EXPECT_EQ(truth[2].timestamp, 0.21);
  EXPECT_EQ(truth[2].T_world_camera.translation(), Eigen::Vector3d(0, 0, 2));
}

TEST_F(KittiTest, ColourComesFirstAndItsCameraStandsBesideTheOrigin) {
  copy_as_colour();
  const auto source = open();
  const std::optional<SensorFrame> frame = source->next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(5, 7), test::colour_image(0).at<cv::Vec3b>(5, 7));
  EXPECT_DOUBLE_EQ(source->describe().camera->baseline, 0.5);
  EXPECT_NEAR(source->truth()[0].T_world_camera.translation().x(), -0.06, 1e-12);
  EXPECT_EQ(open({{"cameras", std::string("grey")}})->truth()[0].T_world_camera.translation().x(), 0.0);
}

TEST_F(KittiTest, APlainPairHasLinesWithoutNamesAndARate) {
  for (int i = 0; i < 2; ++i)
    for (const char* images : {"left", "right"})
      folder_.write_image("plain/" + std::string(images) + "/00" + std::to_string(i) + ".jpg", test::colour_image(i));
  folder_.write("plain/calib.txt", "50 0 32 0 0 50 24 0 0 0 1 0\n50 0 32 -5 0 50 24 0 0 0 1 0\n");
  const auto source = test::make_source("kitti", {{"path", (folder_.path() / "plain").string()}});
  EXPECT_DOUBLE_EQ(source->describe().camera->baseline, 0.1);
  EXPECT_EQ(test::read_all(*source)[1].timestamp, 0.1);
  EXPECT_TRUE(source->truth().empty());
}

TEST_F(KittiTest, SaysWhatIsWrong) {
  const auto message = [&](const std::string& file, const std::string& content) {
    const std::string before = folder_.read(file);
    folder_.write(file, content);
    std::string text = test::input_error([&] { test::read_all(*open()); });
    folder_.write(file, before);
    return text;
  };
  EXPECT_THAT(message("sequences/07/calib.txt", "P0: 1 2 3\n"),
              HasSubstr("calib.txt:1: has 3 numbers; expected the 12"));
  EXPECT_THAT(message("sequences/07/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 x\n"), HasSubstr("found 'x'"));
  EXPECT_THAT(message("sequences/07/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 0\n"),
              HasSubstr("has 1 projection matrices"));
  EXPECT_THAT(message("sequences/07/calib.txt", "50 0 32 0 0 50 24 0 0 0 1 0\n50 0 32 9 0 50 24 0 0 0 1 0\n"),
              HasSubstr("left before right"));
  EXPECT_THAT(message("poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("has 1 poses, but there are 3"));
  EXPECT_THAT(message("poses/07.txt", "2 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("07.txt:1: is not a pose"));
  EXPECT_THAT(message("sequences/07/times.txt", "0\n1\n"), HasSubstr("expected one stamp for each"));
  std::filesystem::remove(folder_.path() / "sequences/07/image_1/000001.png");
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }), HasSubstr("image_1/000001.png"));
  EXPECT_EQ(test::read_all(*open({{"on_bad_frame", std::string("skip")}})).size(), 2U);
  std::filesystem::remove_all(folder_.path() / "sequences/07/image_1");
  EXPECT_THAT(test::input_error([&] { open({{"cameras", std::string("grey")}}); }), HasSubstr("image_1"));
  std::filesystem::remove_all(folder_.path() / "sequences/07/image_0");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("has neither a stereo pair nor a left camera"));
}

TEST_F(KittiTest, TheLeftCameraAlone) {
  std::filesystem::remove_all(folder_.path() / "sequences/07/image_1");
  folder_.write("sequences/07/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 0\n");
  const ParameterValues grey = {{"path", (folder_.path() / "sequences/07").string()}, {"cameras", std::string("grey")}};
  std::unique_ptr<FrameSource> sources[] = {open(), test::make_mono_source("kitti", grey)};
  for (const auto& source : sources) {
    const SourceDescription description = source->describe();
    EXPECT_FALSE(description.has_right);
    EXPECT_FALSE(description.has_depth);
    EXPECT_EQ(description.camera->cx, 32.0);
    EXPECT_EQ(description.frame_timestamps, (std::vector<double>{0.0, 0.1, 0.21}));
    const std::vector<SensorFrame> frames = test::read_all(*source);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_TRUE(frames[2].right.empty());
    EXPECT_EQ(source->truth()[2].T_world_camera.translation(), Eigen::Vector3d(0, 0, 2));
  }
}

}  // namespace
}  // namespace holdfast
