// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mcap/mcap_writer.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/map.hpp"
#include "holdfast/mcap/run_messages.hpp"
#include "mcap_files.hpp"

namespace holdfast {
namespace {

using McapWriterTest = test::McapFilesTest;

/// A run in which everything happens that becomes a message.
void write_run(mcap::MessageSink& sink) {
  const Camera camera;
  mcap::RunMessages messages(sink, {.image_every = 1, .quality = 80}, camera);
  for (std::uint64_t i = 0; i < 3; ++i) {
    SensorFrame sensor_frame;
    sensor_frame.index = i;
    sensor_frame.colour = cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 200, 30));
    Frame frame;
    frame.coarse.grid.columns = 4, frame.coarse.grid.rows = 3;
    FrameResult result;
    result.timestamp = 1.5 + 0.1 * static_cast<double>(i);
    result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, static_cast<double>(i)));
    result.health.state = i == 2 ? HealthState::lost : HealthState::good;
    if (i == 2) result.health.reasons.add(HealthReason::few_inliers);
    MovingObject object;
    object.id = 7;
    object.class_name = "person";
    object.moving = true;
    object.velocity = Eigen::Vector3d(0.0, 0.0, 2.0);
    object.box = Eigen::AlignedBox3f(Eigen::Vector3f(-1, -2, -3), Eigen::Vector3f(1, 2, 3));
    result.objects = {object};
    messages.add_frame(sensor_frame, frame, result);
  }
  Map map;
  map.add_point(Eigen::Vector3d(1, 2, 3), 0);
  messages.add_map(make_snapshot(map), messages.time());
}

// Every message is checked against the schema in the file, and against that which Foxglove publishes.
TEST_F(McapWriterTest, ReadersOfOthersGetARun) {
  if (!tools().trouble().empty()) GTEST_SKIP() << tools().trouble();
  for (const mcap::Compression compression : {mcap::Compression::none, mcap::Compression::zstd}) {
    mcap::McapWriter writer(folder_ / "run.mcap", "", compression);
    write_run(writer);
    writer.close();
    const nlohmann::json found = read_by_others(folder_ / "run.mcap");
    const nlohmann::json& topics = found["topics"];
    EXPECT_EQ(topics.size(), 10U) << topics;
    for (const char* topic :
         {"/status", "/camera/pose", "/objects", "/camera/image", "/camera/moving", "/camera/calibration"})
      EXPECT_EQ(topics[topic]["count"], 3) << topic;
    EXPECT_EQ(topics["/tf"]["count"], 6);
    EXPECT_EQ(topics["/camera/pose"]["time"], "1700000000");
    EXPECT_EQ(topics["/camera/pose"]["last"]["pose"]["position"]["z"], 2.0);
    EXPECT_EQ(topics["/log"]["count"], 2) << "only what changes is logged";
    EXPECT_EQ(topics["/log"]["last"]["message"], "lost: few inliers");
    EXPECT_EQ(topics["/log"]["last"]["level"], 4);
    EXPECT_EQ(topics["/map/points"]["last"]["data"], "AACAPwAAAEAAAEBA");  // 1, 2, 3 as float32
    EXPECT_EQ(topics["/camera/calibration"]["last"]["K"][0], Camera().fx);
  }
}

}  // namespace
}  // namespace holdfast
