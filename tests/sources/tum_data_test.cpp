// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_tum(holdfast::Registry& registry);

namespace holdfast {
namespace {

TEST(TumSourceData, ReadsTheRealRecording) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA is not set; it names the folder that holds tum_fr1_xyz";
  const std::filesystem::path path = std::filesystem::path(data) / "tum_fr1_xyz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";

  Registry registry;
  holdfast_register_plugin_tum(registry);
  const auto source = registry.create<FrameSource>("tum", {{"path", path.string()}}, {});
  EXPECT_EQ(source->describe().name, "tum_fr1_xyz");
  EXPECT_EQ(source->describe().frame_count, 792u);
  EXPECT_EQ(source->truth().size(), 3000u);
  const std::optional<SensorFrame> frame = source->next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->timestamp, 1305031102.175304);
  EXPECT_EQ(frame->colour.size(), cv::Size(640, 480));
  EXPECT_EQ(frame->depth.size(), cv::Size(640, 480));
  double nearest = 0.0, farthest = 0.0;
  cv::minMaxLoc(frame->depth, &nearest, &farthest);
  EXPECT_EQ(nearest, 0.0);
  EXPECT_GT(farthest, 1.0);
  EXPECT_LT(farthest, 65535.0 / 5000.0);
}

}  // namespace
}  // namespace holdfast
