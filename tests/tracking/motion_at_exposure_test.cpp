// SPDX-License-Identifier: BSD-3-Clause
// TrackingContext::motion_at_exposure().
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "holdfast/core/imu.hpp"
#include "holdfast/geometry/so3.hpp"
#include "holdfast/simulation/imu_sensor.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "holdfast/tracking/tracking_context.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

/// The tracking context of a camera whose poses are given.
class ExposureTest : public ::testing::Test {
 protected:
  void make(std::optional<ImuCalibration> imu) {
    TrackingSettings settings;
    settings.inertia = imu.has_value();
    TrackerParts parts{world_.camera(), extractor_, depth_, optimizer_, detector_, moving_world_, map_};
    parts.imu = std::move(imu);
    context_.emplace(settings, parts);
    Frame first;
    first.camera = std::make_shared<const Camera>(world_.camera());
    keyframe_ = map_.add_keyframe(first);
  }
  /// Makes a frame with this pose the current one, after the one before was tracked.
  void track(double timestamp, const Eigen::Isometry3d& T_camera_world) {
    if (is_begun_) {
      context_->history.add(context_->current, keyframe_, map_);
      context_->previous = context_->current;
    }
    is_begun_ = true;
    context_->current.timestamp = timestamp;
    context_->current.T_camera_world = T_camera_world;
  }
  Eigen::Vector3d rotation_at_exposure() const {
    return context_->motion_at_exposure(context_->measured_step())->tangent.tail<3>();
  }

  test::PointWorld world_{find_camera("tum_fr3").value()};
  test::PointExtractor extractor_{world_};
  ImageDepth depth_{world_.camera(), 0.0};
  test::PoseOptimizer optimizer_;
  test::BruteForceDetector detector_;
  Map map_;
  MovingWorld moving_world_{{.camera = world_.camera()}, map_};
  std::optional<TrackingContext> context_;
  KeyFrameId keyframe_;
  bool is_begun_ = false;
};

/// A camera that turns about y, faster and faster.
Eigen::Isometry3d turning(double time) {
  return Eigen::Isometry3d(geometry::exp_so3({0.0, 0.5 * 12.0 * time * time, 0.0}));
}

TEST_F(ExposureTest, TheTurnIsExtrapolatedFromStepsOfAboutTheSameLength) {
  make(std::nullopt);
  for (const double time : {0.0, 0.04, 0.08}) track(time, turning(time));
  EXPECT_NEAR(rotation_at_exposure().y(), 0.04 * 12.0 * (0.06 + 0.3 * 0.04), 1e-9);
  track(0.26, turning(0.26));  // frames are missing
  EXPECT_NEAR(rotation_at_exposure().y(), 0.18 * 12.0 * 0.17, 1e-9);
  track(0.30, turning(0.30));
  EXPECT_NEAR(rotation_at_exposure().y(), 0.04 * 12.0 * 0.28, 1e-9);
  context_->history.interrupt();
  track(0.34, turning(0.34));
  EXPECT_NEAR(rotation_at_exposure().y(), 0.04 * 12.0 * 0.32, 1e-9);
}

TEST_F(ExposureTest, AGyroscopeKnowsTheTurn) {
  const ImuCalibration imu = *find_imu("bmi055");
  make(imu);
  const simulation::Simulator simulator(simulation::read_scene({}, {"camera.path=xyz", "seed=3", "duration=5"}),
                                        world_.camera());
  const simulation::CameraPath& path = simulator.path();
  simulation::ImuSensor sensor(path, imu, 1);
  std::map<double, Eigen::Isometry3d> poses;
  constexpr double interval = 1.0 / 30.0;
  for (int i = 0; i < 120; ++i) {
    SensorFrame frame;
    frame.timestamp = i * interval;
    frame.imu = sensor.take(frame.timestamp);
    const Eigen::Isometry3d T_camera_world = path.pose(frame.timestamp).inverse();
    track(frame.timestamp, T_camera_world);
    context_->inertia.begin_frame(frame);
    poses[frame.timestamp] = T_camera_world;
    if (i + 1 < 120)
      context_->inertia.found(T_camera_world, 0.0, [&](double stamp) { return std::optional(poses.at(stamp)); });
  }
  ASSERT_TRUE(context_->inertia.is_reliable());
  const double time = context_->current.timestamp, step = 1e-3;
  const Eigen::Isometry3d T_later_earlier = path.pose(time + step).inverse() * path.pose(time - step);
  const Eigen::Vector3d expected = interval / (2.0 * step) * geometry::log_so3(T_later_earlier.linear());
  EXPECT_GT(expected.norm(), 0.02 * interval);
  EXPECT_LT((rotation_at_exposure() - expected).norm(), 0.01 * interval);
}

}  // namespace
}  // namespace holdfast
