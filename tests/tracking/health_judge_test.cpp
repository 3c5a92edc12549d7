// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/health_judge.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

class HealthJudgeTest : public testing::Test {
 protected:
  static FrameResult tracked(double x = 0.0) {
    FrameResult result;
    result.status = TrackingStatus::tracked;
    result.features = 1000, result.static_features = 900, result.inliers = 300;
    result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.0));
    result.covariance = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    return result;
  }
  static FrameResult lost() {
    FrameResult result = tracked();
    result.status = TrackingStatus::lost;
    result.T_world_camera.reset();
    result.covariance.reset();
    return result;
  }
  FrameHealth judge(const FrameResult& result, TrackerState state = TrackerState::tracking) {
    return judge_.judge(result, state, [this] { return hides_most_; });
  }

  HealthJudge judge_{TrackingSettings()};
  bool hides_most_ = false;
};

TEST_F(HealthJudgeTest, GoesThroughItsStates) {
  FrameResult result;
  EXPECT_EQ(judge(result, TrackerState::waiting).state, HealthState::waiting);
  result = tracked();
  result.status = TrackingStatus::initialised;
  EXPECT_EQ(judge(result).state, HealthState::good);
  EXPECT_EQ(judge(tracked()).state, HealthState::good);
  EXPECT_EQ(judge(lost(), TrackerState::lost).state, HealthState::lost);
  const FrameHealth found = judge(tracked(0.4));
  EXPECT_EQ(found.state, HealthState::relocalised);
  EXPECT_NEAR(found.jump, 0.4, 1e-12);
  EXPECT_EQ(judge(tracked(0.4)).state, HealthState::good);
  EXPECT_EQ(judge(tracked(0.4), TrackerState::unconfirmed).state, HealthState::degraded);
  result = tracked();
  result.status = TrackingStatus::inertial;
  EXPECT_EQ(judge(result).state, HealthState::inertial);
  result.status = TrackingStatus::initialised;
  EXPECT_TRUE(judge(result).reasons.has(HealthReason::new_map));
}

TEST_F(HealthJudgeTest, ALoopThatMovesTheMapIsAJump) {
  judge(tracked());
  judge_.follow_map(Eigen::Isometry3d(Eigen::Translation3d(0.01, 0.0, 0.0)));
  EXPECT_EQ(judge(tracked(0.01)).state, HealthState::good);
  judge_.follow_map(Eigen::Isometry3d(Eigen::Translation3d(0.21, 0.0, 0.0)));
  const FrameHealth moved = judge(tracked(0.22));
  EXPECT_EQ(moved.state, HealthState::relocalised);
  EXPECT_NEAR(moved.jump, 0.2, 1e-12);
}

TEST_F(HealthJudgeTest, SaysWhyAPoseIsDegraded) {
  judge(tracked());
  FrameResult few = tracked();
  few.inliers = 35;
  EXPECT_TRUE(judge(few).reasons.has(HealthReason::few_inliers));
  FrameResult flat = tracked();
  (*flat.covariance)(0, 0) = 0.02 * 0.02;
  EXPECT_TRUE(judge(flat).reasons.has(HealthReason::poor_geometry));
  FrameResult fallback = tracked();
  fallback.fallback = TrackingFallback::odometry;
  EXPECT_TRUE(judge(fallback).reasons.has(HealthReason::fallback));
  EXPECT_FALSE(judge(fallback).reasons.has(HealthReason::hidden_view));
  hides_most_ = true;
  EXPECT_TRUE(judge(fallback).reasons.has(HealthReason::hidden_view));
  EXPECT_EQ(judge(tracked()).state, HealthState::good) << "a hidden view alone does not degrade a pose";
}

}  // namespace
}  // namespace holdfast
