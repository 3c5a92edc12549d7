// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/kitti_raw_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double metres_per_degree = 6378137.0 * degree;  // along a meridian, and at the scaled equator

/// The names and the form of the file are those of the data set; the values are ours.
constexpr const char* raw_calibration =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
    "S_00: 80 60\nR_00: 1 0 0 0 1 0 0 0 1\n"
    "S_rect_00: 64 48\nR_rect_00: 0 -1 0 1 0 0 0 0 1\nP_rect_00: 50 0 32 0 0 50 24 0 0 0 1 0\n"
    "S_rect_01: 64 48\nR_rect_01: 1 0 0 0 1 0 0 0 1\nP_rect_01: 50 0 32 -25 0 50 24 0 0 0 1 0\n"
    "S_rect_02: 64 48\nR_rect_02: 1 0 0 0 1 0 0 0 1\nP_rect_02: 50 0 32 3 0 50 24 0 0 0 1 0\n"
    "S_rect_03: 64 48\nR_rect_03: 1 0 0 0 1 0 0 0 1\nP_rect_03: 50 0 32 -22 0 50 24 0 0 0 1 0\n";

/// A drive to the north by a metre a frame; image 1 was lost.
class KittiRawTest : public ::testing::Test {
 protected:
  KittiRawTest() {
    for (int i = 0; i < 4; ++i) {
      char packet[200];
      std::snprintf(packet, sizeof(packet), "%.12f 8.4 112.5 0 0 %.15f 9 9 9\n", 49.0 + northing(i), 90.0 * degree);
      folder_.write(drive("oxts/data/000000000" + std::to_string(i) + ".txt"), packet);
      for (int camera = 0; camera < 4; ++camera) {
        const std::string name = "image_0" + std::to_string(camera);
        if (i == 1) continue;
        cv::Mat grey;
        cv::extractChannel(test::colour_image(i), grey, 0);
        folder_.write_image(drive(name + "/data/000000000" + std::to_string(i) + ".png"),
                            camera < 2 ? grey : test::colour_image(i));
        folder_.write(drive(name + "/timestamps.txt"),
                      "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.074000000\n2011-09-26 13:02:26.170000000\n"
                      "2011-09-26 13:02:26.280000000\n");
      }
    }
    folder_.write(day("calib_cam_to_cam.txt"), raw_calibration);
    // The laser scanner looks along x, and the camera along its own z; the IMU stands 1 m behind the scanner.
    folder_.write(day("calib_velo_to_cam.txt"),
                  "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\n"
                  "T: 0 0 -0.5\ndelta_f: 0 0\n");
    folder_.write(day("calib_imu_to_velo.txt"), "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -1 0 0\n");
  }
  static double northing(int frame) { return frame / metres_per_degree; }
  static std::string day(const std::string& name) { return "2011_09_26/" + name; }
  static std::string drive(const std::string& name) { return day("2011_09_26_drive_0001_sync/" + name); }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = (folder_.path() / drive("")).string();
    return test::make_source("kitti", values);
  }
  std::string error_with(const std::string& file, const std::string& content) const {
    return test::input_error_with(folder_, file, content, [&] { test::read_all(*open()); });
  }
  static std::string changed(const std::string& from, const std::string& to) {
    std::string text = raw_calibration;
    return text.replace(text.find(from), from.size(), to);
  }

  test::TemporaryFolder folder_;
};

TEST_F(KittiRawTest, ReadsPairsByTheirNumbers) {
  const auto source = open();
  const SourceDescription description = source->describe();
  EXPECT_TRUE(description.has_right);
  EXPECT_EQ(description.frame_count, 3U);
  EXPECT_EQ(description.camera->cx, 32.0);
  EXPECT_DOUBLE_EQ(description.camera->baseline, 0.5);
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].colour.at<cv::Vec3b>(5, 7), test::colour_image(2).at<cv::Vec3b>(5, 7));
  EXPECT_NEAR(frames[0].timestamp, 1317042145.964389445, 1e-6);  // date -u -d '2011-09-26 13:02:25' +%s
  EXPECT_NEAR(frames[1].timestamp, 1317042146.17, 1e-6) << "of line 2, counted from 0";
  EXPECT_NEAR(open({{"cameras", std::string("grey")}})->describe().camera->baseline, 0.5, 1e-12);
  std::filesystem::remove_all(folder_.path() / drive("image_03"));
  EXPECT_EQ(test::read_all(*open())[0].colour.at<cv::Vec3b>(5, 7)[1], test::colour_image(0).at<cv::Vec3b>(5, 7)[0])
      << "auto: the grey pair";
  std::filesystem::remove_all(folder_.path() / drive("image_01"));
  EXPECT_FALSE(open()->describe().has_right);
}

TEST_F(KittiRawTest, TheTruthIsThatOfTheRectifiedCamera) {
  const Trajectory grey = open({{"cameras", std::string("grey")}})->truth();
  ASSERT_EQ(grey.size(), 3U);
  // To the north, which is y: z of the camera; the drive is 3 m long, within the curvature of the projection.
  const Eigen::Isometry3d& first = grey[0].T_world_camera;
  EXPECT_NEAR((grey[2].T_world_camera.translation() - first.translation()).y(), 3.0, 1e-4);
  EXPECT_TRUE(first.linear().col(2).isApprox(Eigen::Vector3d::UnitY(), 1e-9)) << first.linear();
  // R_rect_00 turns the camera by a right angle about z: x of the rectified camera is down, where y of the other was.
  EXPECT_TRUE(first.linear().col(0).isApprox(Eigen::Vector3d::UnitZ(), 1e-9)) << first.linear();
  // The scanner is 1 m before the IMU, the camera half a metre before that.
  EXPECT_TRUE(first.translation().isApprox(Eigen::Vector3d(0.0, 1.5, 0.0), 1e-9)) << first.translation().transpose();
  // The colour camera stands 6 cm to the left of it, along x of the rectified camera.
  const Eigen::Isometry3d colour = open()->truth()[0].T_world_camera;
  EXPECT_TRUE((first.inverse() * colour.translation()).isApprox(Eigen::Vector3d(-0.06, 0.0, 0.0), 1e-9));
}

TEST_F(KittiRawTest, ProjectsAsTheDevelopmentKit) {
  const KittiMercator projection({49.0, 8.0, 100.0, 0.0, 0.0, 0.0});
  const Eigen::Isometry3d pose = projection.pose({49.001, 8.001, 101.0, 0.1, 0.2, 0.3});
  // A degree of latitude is as long everywhere on the sphere, a degree of longitude shorter by the cosine.
  EXPECT_NEAR(pose.translation().x(), 0.001 * metres_per_degree * std::cos(49.0 * degree), 1e-6);
  EXPECT_NEAR(pose.translation().y(), 0.001 * metres_per_degree, 2e-3);
  EXPECT_NEAR(pose.translation().z(), 1.0, 1e-12);
  EXPECT_NEAR(pose.linear()(2, 0), -std::sin(0.2), 1e-12);
  EXPECT_NEAR(std::atan2(pose.linear()(2, 1), pose.linear()(2, 2)), 0.1, 1e-12);
  EXPECT_NEAR(std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)), 0.3, 1e-12);
}

TEST_F(KittiRawTest, SaysWhatIsWrong) {
  const std::string cameras = day("calib_cam_to_cam.txt");
  EXPECT_THAT(error_with(cameras, changed("P_rect_02", "P_x")), HasSubstr("lacks P_rect_02"));
  EXPECT_THAT(error_with(cameras, changed("P_rect_03: 50 0", "P_rect_03: 50")),
              AllOf(HasSubstr("calib_cam_to_cam.txt:16: has 11 numbers"), HasSubstr("the 12 of P_rect_03")));
  EXPECT_THAT(error_with(cameras, changed("P_rect_02: 50 0", "P_rect_02: 50 1")),
              HasSubstr("is not the projection of a rectified camera"));
  EXPECT_THAT(error_with(cameras, changed("R_rect_00: 0", "R_rect_00: 2")), HasSubstr("txt:6: is not a rotation"));
  EXPECT_THAT(error_with(cameras, changed("S_rect_02: 64 48", "S_rect_02: 70 50")),
              AllOf(HasSubstr("has 64x48 pixels; expected the 70x50"), HasSubstr("_sync, not _extract")));
  EXPECT_THAT(error_with(day("calib_imu_to_velo.txt"), "R: 1 0 0 0 1 0 0 0 1\n"), HasSubstr("lacks T"));
  EXPECT_THAT(error_with(drive("oxts/data/0000000002.txt"), "49 8.4 112.5 0 0\n"),
              AllOf(HasSubstr("0000000002.txt:1: is not a packet"), HasSubstr("latitude")));
  EXPECT_THAT(error_with(drive("oxts/data/0000000002.txt"), "490 8.4 112.5 0 0 0\n"), HasSubstr("latitude"));
  EXPECT_THAT(error_with(drive("image_02/timestamps.txt"), "2011-09-26 13:02:25.9\n2011-09-26 13:02:26\n"),
              AllOf(HasSubstr("has 2 stamps"), HasSubstr("0000000002.png")));
  EXPECT_THAT(error_with(drive("image_02/timestamps.txt"), "2011-09-26 13:02:25.9\n2011-13-26 13:02:26\n"),
              HasSubstr("timestamps.txt:2: found '2011-13-26 13:02:26'"));
  EXPECT_THAT(error_with(drive("image_02/timestamps.txt"), "2011-09-26 13:02:25.9\n2011-09-26 13:02:25\n"),
              HasSubstr("not later than the one before"));
  std::filesystem::remove_all(folder_.path() / drive("oxts"));
  EXPECT_TRUE(open()->truth().empty());
  std::filesystem::remove(folder_.path() / cameras);
  EXPECT_THAT(test::input_error([&] { open(); }),
              AllOf(HasSubstr("2011_09_26/calib_cam_to_cam.txt"), HasSubstr("calibration of the day")));
}

}  // namespace
}  // namespace holdfast
