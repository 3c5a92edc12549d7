// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/health_judge.hpp"

#include <gtest/gtest.h>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"

namespace holdfast {
namespace {

const Camera camera = [] {
  Camera c;
  c.width = 640, c.height = 480;
  c.fx = c.fy = 500.0, c.cx = 320.0, c.cy = 240.0, c.baseline = 0.08;
  return c;
}();

/// Points before the camera at the identity, observed with `noise` times the noise that the adjustment expects.
PoseProblem noisy_problem(double noise, Random& random) {
  PoseProblem problem;
  problem.camera = &camera;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p(random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(1.5, 4.0));
    const double x = camera.fx * p.x() / p.z() + camera.cx + noise * random.normal();
    const double disparity = camera.fx * camera.baseline / p.z() + noise * geometry::disparity_sigma * random.normal();
    problem.points.push_back(p);
    problem.x.push_back(static_cast<float>(x));
    problem.y.push_back(static_cast<float>(camera.fy * p.y() / p.z() + camera.cy + noise * random.normal()));
    problem.right_x.push_back(static_cast<float>(x - disparity));
    problem.inverse_sigma2.push_back(1.0F);
    problem.weight.push_back(1.0F);
    problem.inlier.push_back(0);
  }
  return problem;
}

TEST(CalibratedCovariance, AgreesWithMonteCarloAtAnyNoise) {
  for (const double noise : {0.3, 0.6}) {
    Random random(7);
    constexpr int runs = 200;
    double nees = 0.0;
    for (int run = 0; run < runs; ++run) {
      PoseProblem problem = noisy_problem(noise, random);
      const PoseSummary summary = geometry::adjust_pose(problem);
      ASSERT_TRUE(summary.usable);
      const geometry::Vector6d error = geometry::log_se3(problem.T_camera_world);
      // The noise of these points is independent.
      const geometry::Matrix6d covariance = calibrated_covariance(problem, summary.covariance) / correlation_factor;
      nees += error.dot(covariance.ldlt().solve(error)) / runs;
    }
    // 95 % of chi-square with 1200 degrees of freedom, and 5 % for the variance factor, which outliers bound.
    EXPECT_GT(nees, 5.53 * 0.95) << noise;
    EXPECT_LT(nees, 6.49 * 1.05) << noise;
  }
}

TEST(CalibratedCovariance, OfExactMatchesIsPositiveDefinite) {
  Random random(1);
  PoseProblem problem = noisy_problem(0.0, random);
  const PoseSummary summary = geometry::adjust_pose(problem);
  EXPECT_GT(calibrated_covariance(problem, summary.covariance).llt().matrixL().toDenseMatrix().diagonal().minCoeff(),
            0.0);
}

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
    return judge_.judge(result, state, view_);
  }

  HealthJudge judge_{TrackingSettings()};
  CoarseView view_;
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
  view_.grid.columns = 10, view_.grid.rows = 10;
  view_.mask.assign(100, 1, 255);
  EXPECT_TRUE(judge(fallback).reasons.has(HealthReason::hidden_view));
  EXPECT_EQ(judge(tracked()).state, HealthState::good) << "a hidden view alone does not degrade a pose";
}

}  // namespace
}  // namespace holdfast
