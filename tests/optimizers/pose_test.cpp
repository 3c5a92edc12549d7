// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "both_optimizers.hpp"
#include "geometry/synthetic.hpp"
#include "holdfast/geometry/pose_problem.hpp"

namespace holdfast {
namespace {

const Camera camera = synthetic::camera();

std::unique_ptr<Optimizer> make(const ParameterValues& values = {}) { return make_optimizer("ceres", values); }

/// The same pose by Ceres: a bundle with one free pose, whose points are pinned by two fixed poses that see them from
/// the front and from the side with overwhelming certainty.
BundleProblem as_bundle(const PoseProblem& problem) {
  BundleProblem bundle;
  bundle.camera = problem.camera;
  bundle.poses = {{problem.T_camera_world, false}};
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const auto point = static_cast<std::uint32_t>(i);
    bundle.points.push_back(problem.points[i]);
    bundle.observations.push_back({0, point, problem.x[i], problem.y[i], problem.right_x[i], problem.inverse_sigma2[i],
                                   problem.weight[i], false});
    // Each point has cameras of its own, at one metre from it: its pixel is the principal point, to the last bit.
    for (const bool from_the_side : {false, true}) {
      Eigen::Isometry3d witness = Eigen::Isometry3d::Identity();
      if (from_the_side) witness.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
      witness.translation() = Eigen::Vector3d(0, 0, 1) - witness.linear() * problem.points[i];
      bundle.poses.push_back({witness, true});
      BundleProblem::Observation exact;
      exact.pose = static_cast<std::uint32_t>(bundle.poses.size() - 1);
      exact.point = point;
      exact.x = static_cast<float>(problem.camera->cx);
      exact.y = static_cast<float>(problem.camera->cy);
      exact.right_x = std::numeric_limits<float>::quiet_NaN();
      exact.inverse_sigma2 = 1e8f;
      bundle.observations.push_back(exact);
    }
  }
  bundle.robust_iterations = bundle.final_iterations = 50;
  return bundle;
}

/// How far apart the two solvers end, in squared standard deviations.
double disagreement(double outliers, double limit, bool is_robust, std::uint64_t seed) {
  Camera round = camera;  // numbers that floats hold exactly
  round.fx = round.fy = 512.0, round.cx = 320.0, round.cy = 240.0, round.baseline = 0.0625;
  synthetic::PoseCase c = synthetic::pose_case(round, 200, 1.0, outliers, seed);
  for (std::size_t i = 0; i < c.problem.size(); ++i) c.problem.weight[i] = 0.3f + 0.1f * static_cast<float>(i % 8);
  BundleProblem bundle = as_bundle(c.problem);
  if (is_robust) bundle.final_iterations = 0;
  const std::atomic<bool> stop = false;
  const ParameterValues settings = {
      {"function_tolerance", 1e-12}, {"chi_square_two", limit}, {"chi_square_three", limit}};
  EXPECT_TRUE(make(settings)->optimize_bundle(bundle, stop).usable);
  geometry::PoseAdjustmentOptions options;
  options.chi_square_2d = options.chi_square_3d = limit;
  options.robust_rounds = is_robust ? 1 : 0;
  options.final_rounds = is_robust ? 0 : 1;
  options.iterations = 50;
  const PoseSummary summary = geometry::adjust_pose(c.problem, options);
  EXPECT_TRUE(summary.usable);
  const geometry::Vector6d difference =
      geometry::log_se3(c.problem.T_camera_world * bundle.poses[0].T_camera_world.inverse());
  return difference.dot(summary.covariance.inverse() * difference);
}

TEST(OptimizePose, AgreesWithCeres) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(disagreement(0.0, 1000.0, false, seed), 1e-4) << "plain squares, seed " << seed;
    // Robust rounds end a fifth of a standard deviation from the minimum.
    EXPECT_LT(disagreement(0.2, 6.0, true, seed), 0.1) << "Huber's cost with outliers, seed " << seed;
  }
}

TEST(OptimizePose, SettingsReachTheSolver) {
  for (const std::string name : {"ceres", "schur"}) {
    synthetic::PoseCase loose = synthetic::pose_case(camera, 200, 1.0, 0.0, 1);
    synthetic::PoseCase strict = loose;
    make_optimizer(name, {{"chi_square_two", 100.0}, {"chi_square_three", 100.0}})->optimize_pose(loose.problem);
    make_optimizer(name, {{"chi_square_two", 1.0}, {"chi_square_three", 1.0}})->optimize_pose(strict.problem);
    EXPECT_EQ(std::count(loose.problem.inlier.begin(), loose.problem.inlier.end(), 1), 200) << name;
    EXPECT_LT(std::count(strict.problem.inlier.begin(), strict.problem.inlier.end(), 1), 120) << name;
  }
}

}  // namespace
}  // namespace holdfast
