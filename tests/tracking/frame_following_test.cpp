// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_following.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace holdfast {
namespace {

Eigen::Vector3d position(int frame) { return {0.1 * frame, 0.02 * frame, 0.0}; }

Eigen::Isometry3d turned(double angle) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.36, 0.48, 0.8)));
}

/// T_world_camera.
Eigen::Isometry3d true_pose(int frame) { return Eigen::Translation3d(position(frame)) * turned(0.05 * frame); }

/// 25 frames of a camera that turns on a line; 0, 10 and 20 are keyframes.
class FrameFollowingTest : public testing::Test {
 protected:
  explicit FrameFollowingTest(double interval = 0.1) : interval_(interval) {
    for (int i = 0; i < 25; ++i) {
      Frame frame;
      frame.timestamp = interval_ * i;
      frame.T_camera_world = true_pose(i).inverse();
      if (i % 10 == 0) keyframes_.push_back(map_.add_keyframe(frame));
      history_.add(frame, keyframes_.back(), map_);
      if (i % 10 == 0) history_.became_keyframe(keyframes_.back(), frame.timestamp);
    }
    before_ = placed_frames(history_, map_);
  }

  /// Moves a keyframe as an adjustment does that makes its surroundings `scale` times as large.
  void move(std::size_t keyframe, const Eigen::Isometry3d& T_world_camera, double scale) {
    KeyFrame& moved = map_.keyframe(keyframes_[keyframe]);
    moved.frame.T_camera_world = T_world_camera.inverse();
    moved.scale *= scale;
  }

  Eigen::Isometry3d placed(int frame) const {
    return history_.trajectory(map_).at(static_cast<std::size_t>(frame)).T_world_camera;
  }

  const double interval_;  // s
  Map map_;
  FrameHistory history_;
  std::vector<KeyFrameId> keyframes_;
  PlacedFrames before_;
};

/// The pose that a motion of the whole map in its unit gives a frame.
Eigen::Isometry3d moved_with(const Eigen::Isometry3d& motion, double scale, int frame) {
  Eigen::Isometry3d pose = true_pose(frame);
  pose.translation() *= scale;
  return motion * pose;
}

TEST_F(FrameFollowingTest, AMotionOfTheWholeMapInAnotherUnitMovesAllFramesAlike) {
  const Eigen::Isometry3d motion = Eigen::Translation3d(0.3, -0.2, 0.1) * turned(-0.4);
  for (const int k : {0, 1, 2}) move(static_cast<std::size_t>(k), moved_with(motion, 1.5, 10 * k), 1.5);
  follow_keyframes(history_, map_, before_);
  ASSERT_EQ(history_.trajectory(map_).size(), 25U);
  for (int i = 0; i < 25; ++i) EXPECT_TRUE(placed(i).isApprox(moved_with(motion, 1.5, i), 1e-9)) << i;
}

/// With depth the unit stays: frames between two keyframes lie where both say, by time, those behind the last one
/// where that says.
TEST_F(FrameFollowingTest, FramesAreMovedBetweenTheCorrectionsOfTheirKeyframes) {
  const Eigen::Isometry3d motion = Eigen::Translation3d(0.02, 0.01, -0.03) * turned(0.02);
  move(1, motion * true_pose(10), 1.0);
  move(2, motion * true_pose(20), 1.0);
  follow_keyframes(history_, map_, before_);
  for (int i = 0; i < 25; ++i) {
    const double share = std::min(0.1 * i, 1.0);
    const Eigen::Isometry3d second = motion * true_pose(i);
    EXPECT_LT((placed(i).translation() - (1.0 - share) * position(i) - share * second.translation()).norm(), 1e-9) << i;
    EXPECT_TRUE(placed(i).linear().isApprox((turned(0.02 * share) * turned(0.05 * i)).linear(), 1e-9)) << i;
  }
}

TEST_F(FrameFollowingTest, TheUnitChangesGraduallyBetweenKeyframesOfDifferentUnits) {
  Eigen::Isometry3d pose = true_pose(10);
  pose.translation() *= 1.2;
  move(1, pose, 1.4);
  follow_keyframes(history_, map_, before_);
  for (int i = 0; i <= 10; ++i) {
    const double share = 0.1 * i;
    const Eigen::Vector3d by_second = 1.2 * position(10) + 1.4 * (position(i) - position(10));
    EXPECT_LT((placed(i).translation() - (1.0 - share) * position(i) - share * by_second).norm(), 1e-9) << i;
  }
}

/// Keyframes 2.5 s apart.
class RareKeyframes : public FrameFollowingTest {
 protected:
  RareKeyframes() : FrameFollowingTest(0.25) {}
};

TEST_F(RareKeyframes, FramesStayRelativeToTheirReference) {
  move(1, Eigen::Translation3d(0.1, 0.0, 0.0) * true_pose(10), 1.0);
  follow_keyframes(history_, map_, before_);
  for (int i = 0; i < 20; ++i)
    EXPECT_TRUE(placed(i).isApprox(Eigen::Translation3d(i < 10 ? 0.0 : 0.1, 0.0, 0.0) * true_pose(i), 1e-9)) << i;
}

}  // namespace
}  // namespace holdfast
