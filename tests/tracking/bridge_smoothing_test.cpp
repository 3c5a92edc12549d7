// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/bridge_smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_schur(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr double frame_interval = 0.04;
constexpr int frame_count = 100, first_bridged = 40, last_bridged = 70;

/// A camera that swings along x without turning; its IMU has the camera's frame.
Eigen::Isometry3d pose_at(double time) {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.translation().x() = 0.3 * std::sin(2.0 * time);
  return T_world_camera;
}
Eigen::Vector3d force_at(double time) { return {-1.2 * std::sin(2.0 * time), -standard_gravity, 0.0}; }

/// A history in which the bridged frames drift away by `drift` at the end of the bridge.
class BridgeTest : public testing::Test {
 protected:
  BridgeTest() {
    inertia.set_estimates(estimates(), 0);
    for (int i = 0; i < frame_count; ++i) add_frame(i);
  }
  static MapInertia estimates() {
    MapInertia result;
    result.gravity = {0.0, standard_gravity, 0.0};
    return result;
  }
  void add_frame(int i) {
    SensorFrame measured;
    measured.timestamp = frame_interval * i;
    for (int k = -9; k <= 1; ++k) {
      const double time = measured.timestamp + 0.005 * k;
      measured.imu.push_back({time, Eigen::Vector3d::Zero(), force_at(time)});
    }
    inertia.add(measured);
    Frame frame;
    frame.timestamp = measured.timestamp;
    Eigen::Isometry3d T_world_camera = pose_at(frame.timestamp);
    const bool is_bridged = i >= first_bridged && i <= last_bridged;
    if (is_bridged) T_world_camera.translation().y() += 0.15 * (i - first_bridged) / (last_bridged - first_bridged);
    frame.T_camera_world = T_world_camera.inverse();
    history.add(frame, reference, map);
    if (is_bridged) drifting.frames.push_back(frame.timestamp);
  }
  static Frame keyframe() {
    Frame frame;
    frame.camera = std::make_shared<Camera>(find_camera("tum_fr3").value());
    return frame;
  }
  double largest_error() const {
    double largest = 0.0;
    for (const TimedPose& pose : history.trajectory(map))
      largest = std::max(largest, (pose.T_world_camera.translation() - pose_at(pose.timestamp).translation()).norm());
    return largest;
  }

  Map map;
  KeyFrameId reference = map.add_keyframe(keyframe());
  FrameHistory history;
  DriftingPoses drifting;
  InertialHistory inertia{*find_imu("bmi055")};
  std::unique_ptr<Optimizer> optimizer = [] {
    Registry registry;
    holdfast_register_plugin_schur(registry);
    return registry.create<Optimizer>("schur", {}, {});
  }();
};

TEST_F(BridgeTest, FramesOfABridgeFollowTheFramesOnBothSides) {
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
  EXPECT_EQ(smooth_bridges(history, map, drifting, inertia, *optimizer), 31U);
  EXPECT_LT(largest_error(), 0.005);
}

/// As where no adjustment of the map follows the bridge.
TEST_F(BridgeTest, IsNotHeldByItsOwnKeyframes) {
  const double middle = drifting.frames[15];
  std::erase(drifting.frames, middle);
  drifting.keyframes.push_back(middle);
  EXPECT_EQ(smooth_bridges(history, map, drifting, inertia, *optimizer), 30U);
  for (const TimedPose& pose : history.trajectory(map)) {
    if (pose.timestamp == middle) continue;
    EXPECT_LT((pose.T_world_camera.translation() - pose_at(pose.timestamp).translation()).norm(), 0.006)
        << pose.timestamp;
  }
}

TEST_F(BridgeTest, StaysWithoutMeasurements) {
  const InertialHistory nothing(*find_imu("bmi055"));
  EXPECT_EQ(smooth_bridges(history, map, drifting, nothing, *optimizer), 0U);
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
}

TEST_F(BridgeTest, StaysWhereNoTrackedFrameFollows) {
  add_frame(frame_count);
  drifting.frames.push_back(frame_interval * frame_count);
  const Eigen::Isometry3d before = history.trajectory(map).back().T_world_camera;
  smooth_bridges(history, map, drifting, inertia, *optimizer);
  EXPECT_EQ(history.trajectory(map).back().T_world_camera.matrix(), before.matrix());
}

}  // namespace
}  // namespace holdfast
