// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_history.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

Eigen::Isometry3d pose(double angle, const Eigen::Vector3d& position) {
  Eigen::Isometry3d result(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()));
  result.translation() = position;
  return result;
}

Frame frame_at(double timestamp, const Eigen::Isometry3d& T_camera_world) {
  Frame frame;
  frame.timestamp = timestamp;
  frame.T_camera_world = T_camera_world;
  return frame;
}

/// A keyframe at the time 0, and frames at 1, 2 and 3 that were tracked against it.
struct Tracked {
  Tracked() {
    history.add(frame_at(0.0, map.keyframe(reference).frame.T_camera_world), reference, map);
    history.became_keyframe(reference, 0.0);
    for (int i = 1; i <= 3; ++i) {
      poses.push_back(pose(0.9 * i, {0.1 * i, 0.7, -0.3 * i}));
      history.add(frame_at(i, poses.back()), reference, map);
    }
  }
  Map map;
  KeyFrameId reference = map.add_keyframe(frame_at(0.0, pose(0.4, {1.0, 2.0, 3.0})));
  FrameHistory history;
  std::vector<Eigen::Isometry3d> poses;  // T_camera_world
};

TEST(FrameHistory, KeepsThePosesOfAllFrames) {
  const Tracked tracked;
  const Trajectory trajectory = tracked.history.trajectory(tracked.map);
  ASSERT_EQ(trajectory.size(), 4U);
  for (std::size_t i = 0; i < tracked.poses.size(); ++i) {
    EXPECT_EQ(trajectory[i + 1].timestamp, static_cast<double>(i + 1));
    EXPECT_LT((trajectory[i + 1].T_world_camera.matrix() - tracked.poses[i].inverse().matrix()).norm(), 1e-14);
  }
  EXPECT_LT((tracked.history.last_pose(tracked.map).matrix() - tracked.poses.back().matrix()).norm(), 1e-14);
}

TEST(FrameHistory, FramesFollowTheirKeyframe) {
  Tracked tracked;
  const Eigen::Isometry3d T_camera_reference =
      tracked.poses[1] * tracked.map.keyframe(tracked.reference).frame.T_camera_world.inverse();
  const Eigen::Isometry3d corrected = pose(-0.7, {4.0, -1.0, 0.5});
  tracked.map.keyframe(tracked.reference).frame.T_camera_world = corrected;
  const Eigen::Isometry3d expected = (T_camera_reference * corrected).inverse();
  EXPECT_LT((tracked.history.trajectory(tracked.map)[2].T_world_camera.matrix() - expected.matrix()).norm(), 1e-14);
}

TEST(FrameHistory, FramesFollowTheScaleOfTheirKeyframe) {
  Tracked tracked;
  KeyFrame& keyframe = tracked.map.keyframe(tracked.reference);
  keyframe.scale = 2.0;
  tracked.history.add(frame_at(4.0, tracked.poses[0]), tracked.reference, tracked.map);
  keyframe.scale = 6.0;
  const Eigen::Isometry3d T_reference_world = keyframe.frame.T_camera_world;
  const auto expected = [&](std::size_t i, double factor) {
    Eigen::Isometry3d T_camera_reference = tracked.poses[i] * T_reference_world.inverse();
    T_camera_reference.translation() *= factor;
    return Eigen::Isometry3d(T_camera_reference * T_reference_world);
  };
  const Trajectory trajectory = tracked.history.trajectory(tracked.map);
  EXPECT_LT((trajectory[2].T_world_camera.matrix() - expected(1, 6.0).inverse().matrix()).norm(), 1e-13);
  EXPECT_LT((trajectory[4].T_world_camera.matrix() - expected(0, 3.0).inverse().matrix()).norm(), 1e-13);
  EXPECT_LT((tracked.history.last_pose(tracked.map).matrix() - expected(0, 3.0).matrix()).norm(), 1e-13);
}

TEST(FrameHistory, AKeyframeIsItsOwnReference) {
  Tracked tracked;
  const KeyFrameId later = tracked.map.add_keyframe(frame_at(3.0, pose(2.0, {0.0, 0.0, 1.0})));
  tracked.history.became_keyframe(later, 3.0);
  tracked.history.add_before_last(tracked.reference, 2.5);
  const Trajectory trajectory = tracked.history.trajectory(tracked.map);
  ASSERT_EQ(trajectory.size(), 5U);
  EXPECT_EQ(trajectory[3].T_world_camera.matrix(),
            tracked.map.keyframe(tracked.reference).frame.T_world_camera().matrix());
  EXPECT_EQ(trajectory[4].T_world_camera.matrix(), tracked.map.keyframe(later).frame.T_world_camera().matrix());
  EXPECT_EQ(tracked.history.last_pose(tracked.map).matrix(), tracked.map.keyframe(later).frame.T_camera_world.matrix());
}

TEST(FrameHistory, APastPoseIsReplacedOrWithdrawn) {
  Tracked tracked;
  EXPECT_TRUE(tracked.history.past_pose(0.0, tracked.map)->is_keyframe);
  EXPECT_FALSE(tracked.history.past_pose(1.0, tracked.map)->is_keyframe);
  EXPECT_LT((tracked.history.past_pose(1.0, tracked.map)->T_camera_world.matrix() - tracked.poses[0].matrix()).norm(),
            1e-14);
  EXPECT_FALSE(tracked.history.past_pose(1.5, tracked.map));
  const Eigen::Isometry3d other = pose(0.2, {7.0, 8.0, 9.0});
  EXPECT_FALSE(tracked.history.add_past(frame_at(1.0, other), tracked.reference, tracked.map)) << "it had a pose";
  EXPECT_TRUE(tracked.history.add_past(frame_at(1.5, other), tracked.reference, tracked.map));
  const Trajectory trajectory = tracked.history.trajectory(tracked.map);
  ASSERT_EQ(trajectory.size(), 5U);
  for (const std::size_t i : {1U, 2U})
    EXPECT_LT((trajectory[i].T_world_camera.matrix() - other.inverse().matrix()).norm(), 1e-13) << i;
  tracked.history.withdraw(1.0);
  EXPECT_EQ(tracked.history.trajectory(tracked.map)[1].timestamp, 1.5);
  EXPECT_FALSE(tracked.history.past_pose(1.0, tracked.map));
}

}  // namespace
}  // namespace holdfast
