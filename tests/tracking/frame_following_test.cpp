// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_following.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace holdfast {
namespace {

Eigen::Vector3d position(int frame) { return {0.1 * frame, 0.02 * frame, 0.0}; }

/// 25 frames on a line; 0, 10 and 20 are keyframes.
class FrameFollowingTest : public testing::Test {
 protected:
  FrameFollowingTest() {
    for (int i = 0; i < 25; ++i) {
      Frame frame;
      frame.timestamp = 0.1 * i;
      frame.T_camera_world = Eigen::Isometry3d(Eigen::Translation3d(-position(i)));
      if (i % 10 == 0) keyframes_.push_back(map_.add_keyframe(frame));
      history_.add(frame, keyframes_.back(), map_);
      if (i % 10 == 0) history_.became_keyframe(keyframes_.back(), frame.timestamp);
    }
    before_ = placed_frames(history_, map_);
  }

  /// Moves a keyframe as an adjustment does that makes its surroundings `scale` times as large.
  void move(std::size_t keyframe, const Eigen::Vector3d& to, double scale) {
    KeyFrame& moved = map_.keyframe(keyframes_[keyframe]);
    moved.frame.T_camera_world.translation() = -to;
    moved.scale *= scale;
  }

  Eigen::Vector3d placed(int frame) const {
    return history_.trajectory(map_).at(static_cast<std::size_t>(frame)).T_world_camera.translation();
  }

  Map map_;
  FrameHistory history_;
  std::vector<KeyFrameId> keyframes_;
  PlacedFrames before_;
};

/// An adjustment that changes the scale of a map with depth: frames behind the last keyframe follow that one.
TEST_F(FrameFollowingTest, FramesLieBetweenTheirKeyframesAsBefore) {
  for (const std::size_t k : {0U, 1U, 2U}) move(k, 1.02 * position(10 * static_cast<int>(k)), 1.0);
  follow_keyframes(history_, map_, before_);
  ASSERT_EQ(history_.trajectory(map_).size(), 25U);
  for (int i = 0; i < 25; ++i)
    EXPECT_LT((placed(i) - position(i) - 0.02 * position(std::min(i, 20))).norm(), 1e-9) << i;
}

TEST_F(FrameFollowingTest, FramesOfOneCameraFollowTheUnitOfBothKeyframes) {
  for (const std::size_t k : {0U, 1U, 2U}) move(k, 1.5 * position(10 * static_cast<int>(k)), 1.5);
  follow_keyframes(history_, map_, before_);
  for (int i = 0; i < 25; ++i) EXPECT_LT((placed(i) - 1.5 * position(i)).norm(), 1e-9) << i;
}

TEST_F(FrameFollowingTest, TheUnitChangesGraduallyBetweenKeyframesOfDifferentUnits) {
  move(1, 1.2 * position(10), 1.4);
  follow_keyframes(history_, map_, before_);
  for (int i = 0; i <= 10; ++i) {
    const double share = 0.1 * i;
    const Eigen::Vector3d by_second = 1.2 * position(10) + 1.4 * (position(i) - position(10));
    EXPECT_LT((placed(i) - (1.0 - share) * position(i) - share * by_second).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace holdfast
