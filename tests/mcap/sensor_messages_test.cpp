// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mcap/sensor_messages.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/error.hpp"
#include "holdfast/mcap/mcap_writer.hpp"
#include "image_message.hpp"
#include "imu_message.hpp"
#include "mcap_file.hpp"
#include "mcap_files.hpp"

namespace holdfast {
namespace {

using mcap::MessageHeader;
using test::McapFilesTest;
using testing::ElementsAre;

Camera camera_with(const Distortion& distortion) {
  Camera camera;
  camera.width = 64, camera.height = 48;
  camera.fx = 51.5, camera.fy = 52.25, camera.cx = 31.0, camera.cy = 24.5;
  camera.distortion = distortion;
  return camera;
}

class SensorMessagesTest : public McapFilesTest {
 protected:
  std::filesystem::path write(const std::string& type, const std::string& message) const {
    std::filesystem::path file = folder_ / (type + ".mcap");
    mcap::McapWriter writer(file, "ros2", mcap::Compression::zstd);
    writer.write(writer.add_channel(mcap::sensor_channel("/topic", type)), header.stamp, message);
    writer.close();
    return file;
  }
  /// As the source `rosbag` reads it.
  template <class Read>
  auto read(const std::string& type, const std::string& message, const Read& read_message) const {
    const std::filesystem::path file = write(type, message);
    rosbag_plugin::McapFile bag(file, file);
    return read_message(bag.content(bag.messages("/topic").at(0)));
  }
  nlohmann::json read_by_npm(const std::string& type, const std::string& message) const {
    const nlohmann::json found = read_by_others(write(type, message));
    EXPECT_EQ(found["profile"], "ros2");
    EXPECT_EQ(found["topics"]["/topic"]["type"], "sensor_msgs/msg/" + type);
    return found["topics"]["/topic"]["last"];
  }

  // Eleven letters, so that what follows the name is not aligned by chance.
  const MessageHeader header{1'305'031'102'175'304'000, "camera_name"};
};

TEST_F(SensorMessagesTest, TheSourceReadsEveryCamera) {
  for (const Distortion& distortion :
       {Distortion{}, Distortion{.k1 = 0.2, .k2 = -0.5, .p1 = 0.001, .p2 = -0.002, .k3 = 0.3},
        Distortion{.k1 = 0.2, .k2 = -0.05, .k3 = 0.01, .k4 = 0.1, .k5 = 0.02, .k6 = 0.001},
        Distortion{.k1 = 0.01, .k2 = 0.002, .k3 = -0.001, .k4 = 0.0005, .lens = Lens::fisheye}}) {
    const Camera camera = camera_with(distortion);
    const Camera found =
        read("CameraInfo", camera_info_message(header, camera),
             [](const rosbag_plugin::Message& message) { return rosbag_plugin::read_camera_info(message, false); });
    EXPECT_EQ(found.distortion, camera.distortion);
    EXPECT_EQ(found.pinhole().fx, camera.fx);
    EXPECT_EQ(found.fy, camera.fy);
    EXPECT_EQ(found.cx, camera.cx);
    EXPECT_EQ(found.cy, camera.cy);
    EXPECT_EQ(found.width, 64);
    EXPECT_EQ(found.height, 48);
  }
}

TEST_F(SensorMessagesTest, TheSourceReadsTheBaselineOfAPair) {
  Camera camera = camera_with({});
  camera.baseline = 0.12;
  const Camera found =
      read("CameraInfo", right_camera_info_message(header, camera), rosbag_plugin::read_right_camera_info);
  EXPECT_NEAR(found.baseline, 0.12, 1e-15);
  EXPECT_EQ(found.fx, camera.fx);
}

TEST_F(SensorMessagesTest, TheSourceReadsInertialMeasurements) {
  ImuSample sample;
  sample.angular_velocity = {0.1, -0.2, 0.3};
  sample.acceleration = {9.5, 0.25, -1.0};
  const ImuSample found = read("Imu", imu_message(header, sample), rosbag_plugin::read_imu_message);
  EXPECT_EQ(found.timestamp, 1305031102.175304);
  EXPECT_EQ(found.angular_velocity, sample.angular_velocity);
  EXPECT_EQ(found.acceleration, sample.acceleration);
}

TEST_F(SensorMessagesTest, ReadersOfOthersGetEveryField) {
  if (!tools().trouble().empty()) GTEST_SKIP() << tools().trouble();
  const cv::Mat pixels = (cv::Mat_<std::uint16_t>(2, 3) << 1, 2, 3, 4, 5, 0x0607);
  const nlohmann::json image = read_by_npm("Image", image_message(header, "16UC1", pixels.colRange(1, 3)));
  EXPECT_EQ(image["header"]["stamp"]["sec"], 1305031102);
  EXPECT_EQ(image["header"]["stamp"]["nanosec"], 175304000);
  EXPECT_EQ(image["header"]["frame_id"], "camera_name");
  EXPECT_EQ(image["encoding"], "16UC1");
  EXPECT_EQ(image["height"], 2);
  EXPECT_EQ(image["width"], 2);
  EXPECT_EQ(image["step"], 4);
  EXPECT_THAT(image["data"], ElementsAre(2, 0, 3, 0, 5, 0, 7, 6));

  const nlohmann::json compressed = read_by_npm("CompressedImage", compressed_image_message(header, "png", "abc"));
  EXPECT_EQ(compressed["format"], "png");
  EXPECT_THAT(compressed["data"], ElementsAre('a', 'b', 'c'));

  const Camera camera = camera_with({.k1 = 0.2, .k2 = -0.5, .p1 = 0.001, .p2 = -0.002, .k3 = 0.3});
  const nlohmann::json info = read_by_npm("CameraInfo", camera_info_message(header, camera));
  EXPECT_EQ(info["distortion_model"], "plumb_bob");
  EXPECT_THAT(info["d"], ElementsAre(0.2, -0.5, 0.001, -0.002, 0.3));
  EXPECT_THAT(info["k"], ElementsAre(51.5, 0, 31.0, 0, 52.25, 24.5, 0, 0, 1));
  EXPECT_THAT(info["p"], ElementsAre(51.5, 0, 31.0, 0, 0, 52.25, 24.5, 0, 0, 0, 1, 0));
  EXPECT_EQ(info["roi"]["do_rectify"], false);

  ImuSample sample;
  sample.angular_velocity = {0.1, -0.2, 0.3};
  sample.acceleration = {9.5, 0.25, -1.0};
  const nlohmann::json imu = read_by_npm("Imu", imu_message(header, sample));
  EXPECT_EQ(imu["orientation_covariance"][0], -1.0);
  EXPECT_EQ(imu["angular_velocity"]["z"], 0.3);
  EXPECT_EQ(imu["linear_acceleration"]["x"], 9.5);
}

TEST_F(SensorMessagesTest, StampsAreThoseOfLists) {
  EXPECT_EQ(mcap::message_stamp(1305031102.175304), 1'305'031'102'175'304'000U);
  EXPECT_EQ(mcap::message_stamp(1.0 / 3.0), 333'333'333U);
  EXPECT_EQ(mcap::message_stamp(0.0), 0U);
  EXPECT_EQ(mcap::message_stamp(7.0), 7'000'000'000U);
  for (const double stamp : {-1e-3, 2147483648.0, std::nan("")}) EXPECT_THROW(mcap::message_stamp(stamp), Error);
}

}  // namespace
}  // namespace holdfast
