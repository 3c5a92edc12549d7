// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_health(holdfast::Registry&);

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

TEST(HealthTest, WritesPoseCovarianceAndTruth) {
  const fs::path folder = fs::path(testing::TempDir()) / ("holdfast_health_" + std::to_string(getpid()));
  fs::create_directories(folder);
  Registry registry;
  holdfast_register_plugin_health(registry);
  CreationContext context;
  context.output_directory = folder;
  const auto observer = registry.create<Observer>("health", {}, context);
  SensorFrame frame;
  FrameResult result;
  result.timestamp = 1.0;
  result.is_keyframe = true;
  result.keyframe = {3, 0};
  result.health.state = HealthState::good;
  observer->on_frame(frame, {}, result);
  result.timestamp = 1.5;
  result.is_keyframe = false;
  result.health.state = HealthState::degraded;
  result.health.reasons.add(HealthReason::few_inliers);
  result.health.reasons.add(HealthReason::hidden_view);
  result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3));
  result.covariance = 0.25 * Eigen::Matrix<double, 6, 6>::Identity();
  auto truth = std::make_shared<FrameTruth>();
  truth->T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(4, 5, 6));
  frame.truth = truth;
  observer->on_frame(frame, {}, result);
  observer->on_finish(Map());

  std::ifstream stream(folder / "health.csv");
  std::string header, first, second;
  std::getline(stream, header), std::getline(stream, first), std::getline(stream, second);
  const auto columns = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  EXPECT_EQ(columns(first), columns(header));
  EXPECT_EQ(columns(second), columns(header));
  EXPECT_THAT(first, StartsWith("1.000000,good,,0.0000,,,"));
  EXPECT_THAT(second, StartsWith("1.500000,degraded,few inliers;hidden view,0.0000,1.000000,1.000000000,2.000000000,"));
  EXPECT_THAT(second, HasSubstr(",0.25,0,0,0,0,0,0.25,"));
  EXPECT_THAT(second, HasSubstr(",4.000000000,5.000000000,6.000000000,"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace holdfast
