// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "depth_registration.hpp"
#include "sources/recording.hpp"
#include "support/bag_writer.hpp"

namespace holdfast {
namespace {

using test::BagWriter;
using test::ByteText;
using testing::HasSubstr;

const std::string colour_stream = "/device_0/sensor_1/Color_0", depth_stream = "/device_0/sensor_0/Depth_0";
constexpr std::uint64_t begin = 1600000000'000000000ULL;

/// What may be changed in a bag of librealsense.
struct Recorded {
  std::string model = "Inverse Brown Conrady";
  std::vector<double> distortion = {0, 0, 0, 0, 0};
  double baseline = 0.015;
  std::string depth_tf = "/tf/0";
  std::string units = "/device_0/sensor_0/option/Depth Units/value";
  std::uint16_t far = 8000, near = 4000;  ///< in units of 0.25 mm: the right half of the depth image is near
  cv::Mat depth = {};                     ///< replaces these
  Eigen::Quaterniond depth_rotation = Eigen::Quaterniond::Identity(), colour_rotation = depth_rotation;  ///< of `tf`
};

/// A geometry_msgs/Transform from the reference to a stream.
std::string transform_message(double x, const Eigen::Quaterniond& q) {
  ByteText text;
  for (const double number : {x, 0.0, 0.0, q.x(), q.y(), q.z(), q.w()}) text.number(number);
  return text.bytes;
}

/// Two frames. Depth is 32 x 24 pixels of the same view as 64 x 48 of colour, whose camera is to the right of it.
std::string realsense_bag(const Recorded& recorded) {
  BagWriter bag;
  bag.add("/file_version", "std_msgs/UInt32", begin, ByteText().number(std::uint32_t{4}).bytes);
  bag.add(recorded.units, "std_msgs/Float32", begin, ByteText().number(0.00025F).bytes);
  bag.add(depth_stream + "/info/camera_info", "sensor_msgs/CameraInfo", begin,
          test::camera_info_message(0, 32, 24, "Brown Conrady", {0, 0, 0, 0, 0}, {25, 0, 15.5, 0, 25, 11.5, 0, 0, 1},
                                    std::vector<double>(12, 0.0)));
  bag.add(colour_stream + "/info/camera_info", "sensor_msgs/CameraInfo", begin,
          test::camera_info_message(0, 64, 48, recorded.model, recorded.distortion, {50, 0, 31.5, 0, 50, 23.5, 0, 0, 1},
                                    std::vector<double>(12, 0.0)));
  bag.add(depth_stream + recorded.depth_tf, "geometry_msgs/Transform", begin,
          transform_message(0.0, recorded.depth_rotation));
  bag.add(colour_stream + "/tf/0", "geometry_msgs/Transform", begin,
          transform_message(-recorded.baseline, recorded.colour_rotation));
  cv::Mat depth(24, 32, CV_16UC1, cv::Scalar(recorded.far));
  depth(cv::Rect(16, 0, 16, 24)).setTo(recorded.near);
  if (!recorded.depth.empty()) depth = recorded.depth;
  for (int i = 0; i < 2; ++i) {
    const std::uint64_t stamp = begin + 33'000'000ULL * static_cast<unsigned>(i);
    bag.add(colour_stream + "/image/data", "sensor_msgs/Image", stamp,
            test::image_message(stamp, "rgb8", test::colour_image(i)));
    bag.add("/device_0/sensor_0/Infrared_1/image/data", "sensor_msgs/Image", stamp,
            test::image_message(stamp, "mono8", cv::Mat(24, 32, CV_8UC1, cv::Scalar(7))));
    bag.add(depth_stream + "/image/data", "sensor_msgs/Image", stamp, test::image_message(stamp, "mono16", depth));
  }
  return bag.finish();
}

class RealsenseBagTest : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const Recorded& recorded, ParameterValues values = {}) const {
    values["path"] = folder_.write("rs.bag", realsense_bag(recorded));
    values["camera_info"] = colour_stream + "/info/camera_info";
    return test::make_source("rosbag", values);
  }
  std::string error(const Recorded& recorded) const {
    return test::input_error([&] { test::read_all(*open(recorded)); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(RealsenseBagTest, MovesDepthIntoTheViewOfColour) {
  const auto source = open({});
  EXPECT_EQ(source->describe().camera->fx, 50.0);
  EXPECT_TRUE(source->describe().camera->distortion.is_zero());
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].colour.at<cv::Vec3b>(5, 5)[2], 41) << "red and blue change places";
  const cv::Mat& depth = frames[0].depth;
  ASSERT_EQ(depth.size(), cv::Size(64, 48));
  // 15 mm are 50 * 0.015 / 2 = 0.375 pixels at 2 m, and 0.75 pixels at 1 m, to the left.
  EXPECT_EQ(depth.at<float>(20, 10), 2.0F) << "units of 0.25 mm";
  EXPECT_EQ(depth.at<float>(20, 50), 1.0F);
  EXPECT_EQ(depth.at<float>(20, 31), 1.0F) << "the edge is at 31.5, and moves to 30.75";
  EXPECT_EQ(depth.at<float>(20, 30), 2.0F);
  EXPECT_EQ(depth.at<float>(20, 63), 0.0F) << "depth begins at -0.5, and ends at 63.5 - 0.75";
  EXPECT_EQ(cv::countNonZero(depth), 63 * 48) << "no gaps";
}

/// Depth is turned by 3 degrees around y, colour by 2 around x, and the lens of colour distorts. Each pixel of depth is
/// followed to colour as a point.
TEST_F(RealsenseBagTest, TurnsDepthIntoTheViewOfColour) {
  Recorded recorded;
  constexpr double degree = 0.017453292519943295;
  recorded.depth_rotation = Eigen::AngleAxisd(3 * degree, Eigen::Vector3d::UnitY());
  recorded.colour_rotation = Eigen::AngleAxisd(2 * degree, Eigen::Vector3d::UnitX());
  recorded.model = "Brown Conrady";
  recorded.distortion = {-0.05, 0.06, 0.0005, -0.0007, -0.02};
  recorded.depth.create(24, 32, CV_16UC1);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x)
      recorded.depth.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(6000 + 40 * x + 60 * y);
  const auto source = open(recorded);
  const Distortion lens{.k1 = -0.05, .k2 = 0.06, .p1 = 0.0005, .p2 = -0.0007, .k3 = -0.02};
  EXPECT_EQ(source->describe().camera->distortion, lens);
  const cv::Mat depth = source->next()->depth;
  int compared = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      const double z = recorded.depth.at<std::uint16_t>(y, x) * 0.00025;
      const Eigen::Vector3d of_depth((x - 15.5) / 25 * z, (y - 11.5) / 25 * z, z);
      const Eigen::Vector3d reference = recorded.depth_rotation.inverse() * of_depth;
      const Eigen::Vector3d point = recorded.colour_rotation * reference - Eigen::Vector3d(recorded.baseline, 0, 0);
      const double a = point.x() / point.z(), b = point.y() / point.z(), r = a * a + b * b;
      const double f = 1 + lens.k1 * r + lens.k2 * r * r + lens.k3 * r * r * r;
      const long u = std::lround(50 * (a * f + 2 * lens.p1 * a * b + lens.p2 * (r + 2 * a * a)) + 31.5);
      const long v = std::lround(50 * (b * f + 2 * lens.p2 * a * b + lens.p1 * (r + 2 * b * b)) + 23.5);
      if (u < 0 || v < 0 || u >= 64 || v >= 48) continue;
      ++compared;
      EXPECT_NEAR(depth.at<float>(static_cast<int>(v), static_cast<int>(u)), point.z(), 1e-3) << x << ' ' << y;
    }
  EXPECT_GT(compared, 600);
}

TEST_F(RealsenseBagTest, FindsTheCameraOfColour) {
  const Camera none;
  const auto source = test::make_source("rosbag", {{"path", folder_.write("rs.bag", realsense_bag({}))}}, none.width,
                                        none.height, std::nullopt);
  ASSERT_TRUE(source->describe().camera.has_value());
  EXPECT_EQ(source->describe().camera->fx, 50.0);
  EXPECT_EQ(source->describe().camera->width, 64);
}

TEST_F(RealsenseBagTest, RefusesDepthOfAnotherSizeThanItsCalibration) {
  Recorded recorded;
  recorded.depth.create(12, 16, CV_16UC1);
  EXPECT_THAT(error(recorded), testing::AllOf(HasSubstr("is 16x12 pixels, but its camera_info is 32x24"),
                                              HasSubstr("calibration is of another mode")));
}

TEST_F(RealsenseBagTest, UsesTheFactorOfTheConfigurationWithoutUnits) {
  Recorded recorded;
  recorded.units = "/device_0/sensor_0/option/Laser Power/value";
  EXPECT_EQ(open(recorded)->next()->depth.at<float>(20, 10), 8.0F);
  EXPECT_EQ(open(recorded, {{"depth_factor", 4000.0}})->next()->depth.at<float>(20, 10), 2.0F);
}

TEST_F(RealsenseBagTest, InvertsTheInverseDistortion) {
  Recorded recorded;
  recorded.distortion = {-0.05, 0.06, 0.0005, -0.0007, -0.02};
  const Camera camera = *open(recorded)->describe().camera;
  // The model gives the undistorted position of a pixel.
  const auto& d = recorded.distortion;
  for (const auto& [u, v] : std::vector<std::pair<double, double>>{{0, 0}, {63, 47}, {10, 40}, {50, 5}, {31, 24}}) {
    const double x = (u - 31.5) / 50, y = (v - 23.5) / 50, r = x * x + y * y;
    const double f = 1 + d[0] * r + d[1] * r * r + d[4] * r * r * r;
    const Eigen::Vector2d undistorted(x * f + 2 * d[2] * x * y + d[3] * (r + 2 * x * x),
                                      y * f + 2 * d[3] * x * y + d[2] * (r + 2 * y * y));
    const Eigen::Vector2d pixel(50 * undistorted.x() + 31.5, 50 * undistorted.y() + 23.5);
    EXPECT_LT((camera.distort(pixel) - Eigen::Vector2d(u, v)).norm(), 0.01) << u << ' ' << v;
  }
  recorded.model = "Modified Brown Conrady";
  EXPECT_THAT(error(recorded), HasSubstr("'Modified Brown Conrady'"));
}

TEST_F(RealsenseBagTest, RefusesWhatCannotBeRegistered) {
  Recorded recorded;
  recorded.depth_tf = "/tf/1";
  EXPECT_THAT(error(recorded), HasSubstr("relative to different streams"));
  recorded.depth_tf = "/other";
  EXPECT_THAT(error(recorded), HasSubstr("has no topic '/device_0/sensor_0/Depth_0/tf/0'"));
  recorded = {};
  recorded.baseline = 15.0;
  EXPECT_THAT(error(recorded), HasSubstr("which lie in one housing"));
  EXPECT_FALSE(open(recorded, {{"depth", "none"}})->next()->depth.data) << "colour alone";
}

/// Colour has fewer pixels: a pixel of depth goes to the one in which its centre lies.
TEST(DepthRegistration, RoundsToTheNearestPixelOfFewer) {
  Camera depth_camera, colour_camera;
  depth_camera.width = 64, depth_camera.height = 48;
  depth_camera.fx = depth_camera.fy = 64, depth_camera.cx = 31.5, depth_camera.cy = 23.5;
  colour_camera.width = 32, colour_camera.height = 24;
  colour_camera.fx = colour_camera.fy = 32, colour_camera.cx = 15.7,
  colour_camera.cy = 11.7;  // columns 2k and 2k + 1 are k - 0.05, k + 0.45
  const rosbag_plugin::DepthRegistration registration(depth_camera, colour_camera, Eigen::Isometry3d::Identity());
  for (int x = 0; x < 64; ++x) {
    cv::Mat depth(48, 64, CV_32FC1, cv::Scalar(0.0));
    depth.at<float>(2 * x / 3, x) = 2.0F;
    const cv::Mat moved = registration.apply(depth);
    EXPECT_EQ(cv::countNonZero(moved), 1) << x;
    EXPECT_EQ(moved.at<float>(x / 3, x / 2), 2.0F) << x;
  }
}

TEST(DepthRegistration, KeepsTheNearestDepth) {
  Camera camera;
  camera.width = 8, camera.height = 6;
  camera.fx = camera.fy = 8, camera.cx = 3.5, camera.cy = 2.5;
  for (const bool to_the_left : {true, false}) {  // what is near is read after what is far, and before it
    Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
    shift.translation().x() = to_the_left ? -0.5 : 0.5;  // 4 pixels at 1 m, 1 pixel at 4 m
    const auto column = [&](int x) { return to_the_left ? x : 7 - x; };
    cv::Mat depth(6, 8, CV_32FC1, cv::Scalar(4.0));
    depth.col(column(6)).setTo(1.0F);
    const cv::Mat moved = rosbag_plugin::DepthRegistration(camera, camera, shift).apply(depth);
    EXPECT_EQ(moved.at<float>(2, column(2)), 1.0F) << "before what is 4 m away";
    EXPECT_EQ(moved.at<float>(2, column(1)), 4.0F);
    EXPECT_EQ(moved.at<float>(2, column(5)), 0.0F) << "behind what was before it";
    EXPECT_EQ(moved.at<float>(2, column(7)), 0.0F) << "outside of the view of depth";
  }
}

}  // namespace
}  // namespace holdfast
