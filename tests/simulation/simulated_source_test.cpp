// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_simulated(holdfast::Registry& registry);

namespace holdfast {
namespace {

TEST(SimulatedSource, DeliversItsFramesInOrderAndThenEnds) {
  Registry registry;
  holdfast_register_plugin_simulated(registry);
  CreationContext context;
  context.camera = *find_camera("tum_fr1");
  context.camera.width = 320, context.camera.height = 240;
  context.seed = 9;
  const ParameterValues values = {
      {"path", std::string("rpy")}, {"duration", 0.1}, {"set", std::vector<std::string>{"colour_sensor.noise=0"}}};
  const auto source = registry.create<FrameSource>("simulated", values, context);

  const SourceDescription description = source->describe();
  EXPECT_TRUE(description.has_depth);
  EXPECT_EQ(description.frame_count, 3U);
  EXPECT_NE(description.name.find("office, path rpy, seed 9"), std::string::npos) << description.name;
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 3U);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const std::optional<SensorFrame> frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_DOUBLE_EQ(frame->timestamp, static_cast<double>(i) / 30.0);
    EXPECT_EQ(frame->colour.size(), cv::Size(320, 240));
    EXPECT_EQ(frame->depth.size(), cv::Size(320, 240));
    EXPECT_TRUE(frame->truth->T_world_camera->isApprox(truth[i].T_world_camera, 1e-12));
  }
  EXPECT_FALSE(source->next());
  EXPECT_FALSE(source->next());
}

TEST(SimulatedSource, HasTheInertialSensorOfTheConfiguration) {
  Registry registry;
  holdfast_register_plugin_simulated(registry);
  CreationContext context;
  context.camera = *find_camera("tum_fr1");
  context.camera.width = 64, context.camera.height = 48;
  const ParameterValues values = {{"path", std::string("rpy")}, {"duration", 0.1}};
  EXPECT_FALSE(registry.create<FrameSource>("simulated", values, context)->describe().has_imu);
  EXPECT_TRUE(registry.create<FrameSource>("simulated", values, context)->next()->imu.empty());
  context.imu = find_imu("bmi160");
  const auto source = registry.create<FrameSource>("simulated", values, context);
  EXPECT_TRUE(source->describe().has_imu);
  EXPECT_EQ(source->describe().imu, context.imu);
  source->next();
  const SensorFrame second = *source->next();
  EXPECT_EQ(second.imu.size(), 8U) << "0 to 0.035 s";
  EXPECT_NEAR(second.imu.back().acceleration.norm(), standard_gravity, 1.0);
}

}  // namespace
}  // namespace holdfast
