// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_covariance.hpp"

#include <gtest/gtest.h>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"

namespace holdfast {
namespace {

using geometry::Matrix6d;

const Camera camera = [] {
  Camera c;
  c.width = 640, c.height = 480;
  c.fx = c.fy = 500.0, c.cx = 320.0, c.cy = 240.0, c.baseline = 0.08;
  return c;
}();

void observe(const Eigen::Vector3d& p, double error_x, double error_y, double error_disparity, PoseProblem& problem) {
  const double x = camera.fx * p.x() / p.z() + camera.cx + error_x;
  const double disparity = camera.fx * camera.baseline / p.z() + geometry::disparity_sigma * error_disparity;
  problem.points.push_back(p);
  problem.x.push_back(static_cast<float>(x));
  problem.y.push_back(static_cast<float>(camera.fy * p.y() / p.z() + camera.cy + error_y));
  problem.right_x.push_back(static_cast<float>(x - disparity));
  problem.inverse_sigma2.push_back(1.0F);
  problem.weight.push_back(1.0F);
  problem.inlier.push_back(0);
}

/// Points before the camera at the identity, observed with `noise` times the noise that the adjustment expects. Groups
/// of `neighbours` points lie close together, and all of a group have the same error.
PoseProblem noisy_problem(double noise, Random& random, int points = 100, int neighbours = 1) {
  PoseProblem problem;
  problem.camera = &camera;
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3d p(random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(1.5, 4.0));
    const double x = noise * random.normal(), disparity = noise * random.normal(), y = noise * random.normal();
    for (int k = 0; k < neighbours; ++k) observe(p * (1.0 + 1e-3 * k), x, y, disparity, problem);
  }
  return problem;
}

/// Mean normalised squared error of poses with these covariances; 6 is expected.
template <class Covariance>
double mean_nees(const Covariance& covariance_of, double noise, int points, int neighbours) {
  Random random(7);
  constexpr int runs = 200;
  double nees = 0.0;
  for (int run = 0; run < runs; ++run) {
    PoseProblem problem = noisy_problem(noise, random, points, neighbours);
    const PoseSummary summary = geometry::adjust_pose(problem);
    EXPECT_TRUE(summary.usable);
    const geometry::Vector6d error = geometry::log_se3(problem.T_camera_world);
    nees += error.dot(covariance_of(problem, summary.covariance).ldlt().solve(error)) / runs;
  }
  return nees;
}

TEST(PoseCovariance, OfIndependentErrorsAgreesWithMonteCarloAtAnyNoise) {
  for (const double noise : {0.3, 0.6}) {
    const double nees = mean_nees(PoseCovariance::independent, noise, 100, 1);
    // 95 % of chi-square with 1200 degrees of freedom, and 5 % for the variance factor, which outliers bound.
    EXPECT_GT(nees, 5.53 * 0.95) << noise;
    EXPECT_LT(nees, 6.49 * 1.05) << noise;
  }
}

TEST(PoseCovariance, KnowsThatNeighboursShareTheirErrors) {
  PoseCovariance covariance;
  const auto clustered = [&](const auto&... arguments) { return covariance.clustered(arguments...); };
  // Six errors that are the same are taken for six measurements.
  EXPECT_GT(mean_nees(PoseCovariance::independent, 0.4, 150, 6), 25.0);
  EXPECT_NEAR(mean_nees(clustered, 0.4, 150, 6), 6.6,
              1.0);  // with some hundred cells, of which 6 are taken by the pose
  EXPECT_NEAR(mean_nees(clustered, 0.4, 150, 1), 6.6, 1.0);
}

TEST(PoseCovariance, HasTheErrorOfTheReferenceKeyframe) {
  Random random(3);
  PoseCovariance covariance;
  const auto solve = [&](double noise, KeyFrameId reference, const Eigen::Isometry3d& T_current_reference) {
    covariance.begin_frame();
    PoseProblem problem = noisy_problem(noise, random);
    const PoseSummary summary = geometry::adjust_pose(problem);
    return covariance.calibrated_covariance(problem, summary.covariance, reference, T_current_reference);
  };
  const auto identity = Eigen::Isometry3d::Identity();
  const Matrix6d poor = solve(0.8, KeyFrameId(), identity);
  covariance.keyframe_added(KeyFrameId{1});
  solve(0.1, KeyFrameId(), identity);
  covariance.keyframe_added(KeyFrameId{2});
  const Matrix6d by_good = solve(0.2, KeyFrameId{2}, identity);
  const Matrix6d by_unknown = solve(0.2, KeyFrameId{3}, identity);
  const Matrix6d by_poor = solve(0.2, KeyFrameId{1}, identity);
  EXPECT_NEAR(by_good.trace() / by_unknown.trace(), 1.0, 0.3);
  EXPECT_GT(by_poor.trace(), 5.0 * by_unknown.trace());
  EXPECT_LT(by_poor.trace(), poor.trace());
  // A turn of the keyframe moves a frame that is far from it.
  const Eigen::Isometry3d far(Eigen::Translation3d(0.0, 0.0, 10.0));
  EXPECT_GT(solve(0.2, KeyFrameId{1}, far)(0, 0), 20.0 * by_poor(0, 0));

  // A frame whose covariance is another's is no keyframe of the one before.
  covariance.begin_frame();
  covariance.keyframe_added(KeyFrameId{3});
  EXPECT_NEAR(solve(0.2, KeyFrameId{3}, far).trace() / by_unknown.trace(), 1.0, 0.3);
  covariance.forget_map();
  EXPECT_NEAR(solve(0.2, KeyFrameId{1}, far).trace() / by_unknown.trace(), 1.0, 0.3);
}

TEST(PoseCovariance, OfExactMatchesIsPositiveDefinite) {
  Random random(1);
  PoseProblem problem = noisy_problem(0.0, random);
  const PoseSummary summary = geometry::adjust_pose(problem);
  const Matrix6d covariance =
      PoseCovariance().calibrated_covariance(problem, summary.covariance, KeyFrameId(), Eigen::Isometry3d::Identity());
  EXPECT_GT(covariance.llt().matrixL().toDenseMatrix().diagonal().minCoeff(), 0.0);
}

}  // namespace
}  // namespace holdfast
