// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* pinhole = "Pinhole 50.5 50.5 32.25 24.75 0\n64 48\nnone\n64 48\n";

/// Three pairs; the first and the last are keyframes.
class FourSeasonsTest : public ::testing::Test {
 protected:
  FourSeasonsTest() {
    for (int i = 0; i < 3; ++i)
      for (const char* camera : {"cam0", "cam1"}) {
        cv::Mat grey;
        cv::extractChannel(test::colour_image(i), grey, camera[3] == '0' ? 0 : 1);
        folder_.write_image(sequence("undistorted_images/") + camera + "/" + ids[i] + ".png", grey);
      }
    folder_.write(sequence("times.txt"),
                  "1602144000000000001 1602144000.000000 5.1\n"
                  "1602144000033000002 1602144000.033000 5.2\n"
                  "1602144000066000003 1602144000.066000 5.3\n");
    folder_.write(sequence("GNSSPoses.txt"),
                  "# frame_id, translation, rotation, scale, fusion_quality, v3\n"
                  "1602144000000000001,0.0,0.0,0.0,0.0,0.0,0.0,1.0,2.0,1.0,0\n"
                  "1602144000066000003,0.5,0.0,1.5,0.0,0.6,0.0,0.8,2.0,1.0,0\n");
    for (const char* name : {"undistorted_calib_0.txt", "undistorted_calib_1.txt"})
      folder_.write(std::string("calibration/") + name, pinhole);
    folder_.write("calibration/undistorted_calib_stereo.txt",
                  "1.0 0.0 0.0 -0.3\n0.0 1.0 0.0 0.0\n0.0 0.0 1.0 0.0\n0.0 0.0 0.0 1.0\n");
  }
  static std::string sequence(const std::string& name) { return "recording_1/" + name; }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = (folder_.path() / "recording_1").string();
    return test::make_source("four_seasons", values);
  }
  std::string error_with(const std::string& file, const std::string& content) const {
    return test::input_error_with(folder_, file, content, [&] { test::read_all(*open()); });
  }

  static constexpr const char* ids[] = {"1602144000000000001", "1602144000033000002", "1602144000066000003"};
  test::TemporaryFolder folder_;
};

TEST_F(FourSeasonsTest, ReadsPairsCameraAndTheTruthOfKeyframes) {
  const auto source = open();
  const SourceDescription description = source->describe();
  EXPECT_EQ(description.name, "recording_1");
  EXPECT_TRUE(description.has_right);
  EXPECT_EQ(description.camera->fx, 50.5);
  EXPECT_EQ(description.camera->cy, 24.75);
  EXPECT_DOUBLE_EQ(description.camera->baseline, 0.3);
  EXPECT_NEAR(description.camera->frame_rate, 30.3, 0.01);
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].timestamp, 1602144000.033);
  EXPECT_EQ(frames[1].right.at<std::uint8_t>(5, 7), test::colour_image(1).at<cv::Vec3b>(5, 7)[1]);
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth[1].timestamp, frames[2].timestamp);
  EXPECT_EQ(truth[1].T_world_camera.translation(), Eigen::Vector3d(1.0, 0.0, 3.0)) << "scaled to metres";
  EXPECT_TRUE(
      truth[1].T_world_camera.linear().isApprox(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0).toRotationMatrix(), 1e-12));
}

TEST_F(FourSeasonsTest, TheLeftCameraAlone) {
  EXPECT_FALSE(open({{"cameras", std::string("left")}})->describe().has_right);
  std::filesystem::remove_all(folder_.path() / sequence("undistorted_images/cam1"));
  std::filesystem::rename(folder_.path() / "calibration", folder_.path() / "elsewhere");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("source.four_seasons.calibration"));
  const auto source = open({{"calibration", (folder_.path() / "elsewhere").string()}});
  EXPECT_FALSE(source->describe().has_right);
  EXPECT_TRUE(test::read_all(*source)[2].right.empty());
}

TEST_F(FourSeasonsTest, SaysWhatIsWrong) {
  const std::string left = "calibration/undistorted_calib_0.txt", stereo = "calibration/undistorted_calib_stereo.txt";
  EXPECT_THAT(error_with(left, "EquiDistant 50.5 50.5 32.25 24.75 0.1 0 0 0\n64 48\n"),
              HasSubstr("undistorted_calib_0.txt:1: found the camera model 'EquiDistant'; expected 'Pinhole"));
  EXPECT_THAT(error_with(left, "Pinhole 50.5 50.5 32.25 24.75 0.9\n64 48\n"), HasSubstr("of an undistorted camera"));
  EXPECT_THAT(error_with(left, "Pinhole 50.5 50.5 32.25 24.75 0\n64 x\n"), HasSubstr("txt:2: does not have the size"));
  EXPECT_THAT(error_with(left, "Pinhole 50.5 50.5 32.25 24.75 0\n"), HasSubstr("ends too early"));
  EXPECT_THAT(error_with(left, "Pinhole 50.5 50.5 33.25 24.75 0\n64 48\n"), HasSubstr("the equal cameras"));
  EXPECT_THAT(error_with(stereo, "1 0 0 0.3\n"), HasSubstr("has 4 numbers"));
  EXPECT_THAT(error_with(stereo, "1 0 0 0.3 0 1 0 0.1 0 0 1 0 0 0 0 1\n"), HasSubstr("a translation along x"));
  EXPECT_THAT(error_with(sequence("times.txt"), "1 2.0 5\n1 1.0 5\n"), HasSubstr("times.txt:2: has a time stamp"));
  EXPECT_THAT(error_with(sequence("times.txt"), "1.png\n"), HasSubstr("lines 'frame_id timestamp exposure'"));
  const std::string truth = sequence("GNSSPoses.txt");
  EXPECT_THAT(error_with(truth, "1602144000000000001,0,0,0,0,0,0,1\n"), HasSubstr("has 8 values"));
  EXPECT_THAT(error_with(truth, "1602144000000000001,0,0,0,0,0,0,2,1\n"), HasSubstr("a unit quaternion"));
  EXPECT_THAT(error_with(truth, "7,0,0,0,0,0,0,1,1\n"), HasSubstr("has no pose of a frame that times.txt lists"));
  std::filesystem::remove(folder_.path() / sequence("undistorted_images/cam1/") / (std::string(ids[1]) + ".png"));
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }), AllOf(HasSubstr("cam1"), HasSubstr(ids[1])));
  std::filesystem::remove_all(folder_.path() / sequence("undistorted_images"));
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("archive of the undistorted stereo images"));
}

}  // namespace
}  // namespace holdfast
