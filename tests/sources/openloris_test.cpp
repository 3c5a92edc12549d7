// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string matrix(int rows, int columns, const std::string& numbers) {
  return " !!opencv-matrix\n         rows: " + std::to_string(rows) + "\n         cols: " + std::to_string(columns) +
         "\n         dt: d\n         data: [ " + numbers + " ]\n";
}

std::string sensor(const std::string& name, const std::string& model, const std::string& coefficients) {
  return name + ":\n   sensor_type: camera\n   sensor_name: " + name +
         "\n   fps: 30\n   width: 64\n   height: 48\n   model: pinhole\n   intrinsics:" +
         matrix(1, 4, "5.0e+01, 3.2e+01,\n          51., 24.") + "   distortion_model: " + model +
         "\n   distortion_coefficients:" + matrix(1, 5, coefficients);
}

std::string link(const std::string& parent, const std::string& child, const std::string& numbers) {
  return "   -\n      parent_frame: " + parent + "\n      child_frame: " + child +
         "\n      matrix:" + matrix(4, 4, numbers);
}

/// Four frames of each device. The robot goes along x; the D435i looks along it, the T265 as well, below it.
class OpenLorisTest : public ::testing::Test {
 protected:
  OpenLorisTest() {
    std::string lists[4];
    std::string truth = "#Time px py pz qx qy qz qw\n";
    for (int i = 0; i < 4; ++i) {
      const auto add = [&](int list, const std::string& folder, double stamp, const cv::Mat& image) {
        char text[32];
        std::snprintf(text, sizeof(text), "%.6f", stamp);
        const std::string name = folder + '/' + text + ".png";
        folder_.write_image("cafe1-1/" + name, image);
        lists[list] += std::string(text) + ' ' + name + '\n';
      };
      const double stamp = 1560000000.0 + i / 30.0;
      cv::Mat grey;
      cv::extractChannel(test::colour_image(i), grey, 0);
      add(0, "color", stamp, test::colour_image(i));
      add(1, "aligned_depth", stamp + 0.002, test::depth_image(i));
      add(2, "fisheye1", stamp + 0.01, grey);
      if (i != 1) add(3, "fisheye2", stamp + 0.01, grey);
      char line[120];
      std::snprintf(line, sizeof(line), "%.8f %.8f 0.0 0.0 0.0 0.0 0.0 1.0\n", stamp, 1.0 * i);
      truth += line;
    }
    const char* names[] = {"color.txt", "aligned_depth.txt", "fisheye1.txt", "fisheye2.txt"};
    for (int i = 0; i < 4; ++i) folder_.write(full_name(names[i]), lists[i]);
    folder_.write(full_name("depth.txt"), "1560000000.100000 depth/none.png\n");
    folder_.write(full_name("groundtruth.txt"), truth);
    folder_.write(full_name("sensors.yaml"),
                  "%YAML:1.0\n---\n" + sensor("d400_color_optical_frame", "radial-tangential", "0., 0., 0., 0., 0.") +
                      sensor("t265_fisheye1_optical_frame", "Kannala-Brandt", "-0.01, 0.004, 0., 0., 0.") +
                      sensor("t265_fisheye2_optical_frame", "Kannala-Brandt", "-0.01, 0.004, 0., 0., 0."));
    folder_.write(full_name("trans_matrix.yaml"),
                  "%YAML:1.0\n---\ntrans_matrix:\n" +
                      link("t265_fisheye1_optical_frame", "t265_fisheye2_optical_frame", right_of_left) +
                      link("base_link", "d400_color_optical_frame",
                           "0., 0., 1., 2.0e-01, -1., 0., 0., 0., 0., -1., 0., 1., 0., 0., 0., 1.") +
                      // The T265 is given by its parent in it: the link is walked backwards.
                      link("t265_fisheye1_optical_frame", "d400_color_optical_frame",
                           "1., 0., 0., 0., 0., 1., 0., -0.5, 0., 0., 1., 0., 0., 0., 0., 1."));
  }

  static constexpr const char* right_of_left = "1., 0., 0., 0.064, 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.";
  static std::string full_name(const std::string& name) { return "cafe1-1/" + name; }
  std::string full(const std::string& name) const { return (folder_.path() / full_name(name)).string(); }
  std::unique_ptr<FrameSource> open(const std::string& cameras, const std::optional<Sensor>& sensor = {}) const {
    return test::make_source("openloris", {{"path", (folder_.path() / "cafe1-1").string()}, {"cameras", cameras}},
                             test::recording_width, test::recording_height, sensor);
  }
  /// The error after `from` was replaced by `to` in a file.
  std::string error_with(const std::string& name, const std::string& from, const std::string& to,
                         const std::string& cameras = "rgbd") const {
    std::string content = folder_.read(full_name(name));
    const std::size_t place = content.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    content.replace(place, from.size(), to);
    return test::input_error_with(folder_, full_name(name), content, [&] { test::read_all(*open(cameras)); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(OpenLorisTest, ReadsColourWithRegisteredDepth) {
  const auto source = open("rgbd");
  const SourceDescription description = source->describe();
  EXPECT_EQ(description.name, "cafe1-1");
  EXPECT_TRUE(description.has_depth);
  EXPECT_FALSE(description.has_right);
  EXPECT_FALSE(description.has_global_shutter);
  ASSERT_TRUE(description.camera.has_value());
  EXPECT_EQ(description.camera->fx, 50.0);
  EXPECT_EQ(description.camera->fy, 51.0);
  EXPECT_EQ(description.camera->cx, 32.0);
  EXPECT_EQ(description.camera->cy, 24.0);
  EXPECT_EQ(description.camera->frame_rate, 30.0);
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_NEAR(frames[2].depth_delay, 0.002, 1e-6);
  EXPECT_EQ(frames[2].depth.at<float>(10, 20), static_cast<float>((200 + 64 * 10 + 20) / 1000.0)) << "1000 = 1 m";
}

TEST_F(OpenLorisTest, TheTruthOfTheRobotBecomesThatOfTheCamera) {
  const auto source = open("rgbd");
  EXPECT_EQ(source->describe().truth_frame, "transformed");
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 4U);
  const Eigen::Isometry3d& pose = truth[3].T_world_camera;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(3.2, 0.0, 1.0), 1e-9)) << pose.translation().transpose();
  EXPECT_TRUE(pose.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-9)) << "the optical axis";
  const Eigen::Isometry3d left = open("left")->truth()[3].T_world_camera;
  EXPECT_TRUE(left.translation().isApprox(Eigen::Vector3d(3.2, 0.0, 0.5), 1e-9)) << left.translation().transpose();
}

TEST_F(OpenLorisTest, ReadsTheFisheyePairRectified) {
  const auto source = open("stereo");
  EXPECT_TRUE(source->describe().has_right);
  EXPECT_FALSE(source->describe().has_depth);
  EXPECT_TRUE(source->describe().has_global_shutter);
  EXPECT_NEAR(source->describe().camera->baseline, 0.064, 1e-9);
  EXPECT_TRUE(source->describe().camera->distortion.is_zero());
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U) << "an image without a partner makes no frame";
  EXPECT_EQ(frames[0].right.size(), frames[0].colour.size());
  const auto left = open("left");
  EXPECT_EQ(left->describe().camera->distortion.lens, Lens::fisheye);
  EXPECT_EQ(left->describe().camera->distortion.coefficients(), (std::vector<double>{-0.01, 0.004, 0.0, 0.0}));
  EXPECT_EQ(test::read_all(*left).size(), 4U);
}

TEST_F(OpenLorisTest, DepthOfAnotherCameraIsNotTaken) {
  std::filesystem::remove(folder_.path() / full_name("aligned_depth.txt"));
  EXPECT_THAT(test::input_error([&] { open("rgbd"); }), AllOf(StartsWith(full("aligned_depth.txt") + ": is missing"),
                                                              HasSubstr("depth.txt"), HasSubstr("`sensor: mono`")));
  const auto colour = open("rgbd", Sensor::mono);
  EXPECT_FALSE(colour->describe().has_depth);
  EXPECT_EQ(test::read_all(*colour).size(), 4U);
}

TEST_F(OpenLorisTest, ErrorsNameThePlace) {
  EXPECT_THAT(error_with("sensors.yaml", "d400_color", "d400_colour"),
              AllOf(StartsWith(full("sensors.yaml")), HasSubstr("lacks d400_color_optical_frame")));
  EXPECT_THAT(error_with("sensors.yaml", "model: pinhole", "model: omni"),
              AllOf(StartsWith(full("sensors.yaml") + ":9:11: "), HasSubstr("'omni' for model; expected pinhole")));
  EXPECT_THAT(error_with("sensors.yaml", "51., 24.", "51."), HasSubstr("found 3 numbers for intrinsics"));
  EXPECT_THAT(error_with("sensors.yaml", "5.0e+01", "-5.0e+01"), HasSubstr("expected fx, cx, fy, cy"));
  EXPECT_THAT(error_with("sensors.yaml", "radial-tangential", "Brown"), HasSubstr("radial-tangential, Kannala-Brandt"));
  EXPECT_THAT(error_with("sensors.yaml", "width: 64", "width: 640"),
              HasSubstr("64x48 pixels, but the camera is 640x48"));
  EXPECT_THAT(error_with("trans_matrix.yaml", "base_link", "base"),
              HasSubstr("no chain of transforms from base_link to d400_color_optical_frame"));
  EXPECT_THAT(error_with("trans_matrix.yaml", right_of_left, std::string(right_of_left).replace(0, 2, "3.")),
              AllOf(StartsWith(full("trans_matrix.yaml") + ":5:"), HasSubstr("not a rigid motion")));
  EXPECT_THAT(
      error_with("trans_matrix.yaml", right_of_left, std::string(right_of_left).replace(12, 5, "0.000"), "stereo"),
      StartsWith(full("sensors.yaml")));
}

TEST_F(OpenLorisTest, TheSourceTumNamesThisOne) {
  EXPECT_THAT(test::input_error([&] {
                test::make_source("tum", {{"path", (folder_.path() / "cafe1-1").string()}});
              }),
              AllOf(HasSubstr("color.txt and no rgb.txt"), HasSubstr("source: { openloris: { path: ")));
}

}  // namespace
}  // namespace holdfast
