// SPDX-License-Identifier: BSD-3-Clause
// The optimizer `schur` against the reference `ceres`, both run to convergence.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement.hpp"

namespace holdfast {
namespace {

const std::atomic<bool> go_on = false;
const Camera camera = synthetic::camera();

/// Solves the problem with both optimizers until nothing changes, and compares costs, poses, points and outliers.
void expect_agreement(BundleProblem problem, const std::string& what, std::int64_t dense_poses = 60) {
  BundleProblem reference;
  ASSERT_NO_FATAL_FAILURE(expect_same_solution(problem, reference, what, dense_poses, 1e-6));
  for (std::size_t i = 0; i < problem.observations.size(); ++i)
    EXPECT_EQ(problem.observations[i].outlier, reference.observations[i].outlier) << what << ", observation " << i;
}

BundleProblem make_problem(int fixed, int free, int points, int track, double outliers, std::uint64_t seed) {
  return synthetic::bundle_case(camera, fixed, free, points, track, 1.0, outliers, seed).problem;
}

TEST(SchurAgreesWithCeres, OnLocalProblems) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    expect_agreement(make_problem(4, 6, 300, 8, 0.0, seed), "no outliers");
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_agreement(make_problem(4, 6, 300, 8, 0.1, seed), "outliers");
}

TEST(SchurAgreesWithCeres, OnASparseReducedSystem) {
  expect_agreement(make_problem(2, 40, 1500, 8, 0.03, 4), "sparse", 0);
}

TEST(SchurAgreesWithCeres, WithOneFixedPose) { expect_agreement(make_problem(1, 5, 250, 6, 0.0, 5), "one fixed pose"); }

TEST(SchurAgreesWithCeres, WithWeights) {
  BundleProblem problem = make_problem(3, 4, 250, 7, 0.05, 6);
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    problem.observations[i].weight = 0.1f * static_cast<float>(i % 11);
    problem.observations[i].inverse_sigma2 /= static_cast<float>(1 + i % 4);
  }
  expect_agreement(problem, "weights from 0 to 1");
}

TEST(SchurAgreesWithCeres, WithPointsBehindAndNumbersThatAreNotFinite) {
  BundleProblem problem = make_problem(3, 4, 250, 7, 0.02, 7);
  for (std::size_t i = 0; i < problem.points.size(); i += 25) problem.points[i].z() -= 6.0;
  for (std::size_t i = 0; i < problem.observations.size(); i += 97)
    problem.observations[i].x = std::numeric_limits<float>::quiet_NaN();
  expect_agreement(problem, "points behind the cameras");
}

TEST(SchurAgreesWithCeres, WithFewObservations) {
  BundleProblem problem = make_problem(2, 3, 60, 3, 0.0, 8);
  std::vector<int> count(problem.points.size(), 0);
  // Most points keep a single observation with depth, and some two without.
  std::erase_if(problem.observations, [&](const BundleProblem::Observation& observation) {
    const bool is_rich = observation.point % 3 == 0;
    return !is_rich && count[observation.point]++ >= (std::isnan(observation.right_x) ? 2 : 1);
  });
  expect_agreement(problem, "few observations");
}

/// One camera may observe a point twice, by features that both match it.
TEST(SchurAgreesWithCeres, WithTwoObservationsOfAPointByOnePose) {
  BundleProblem problem = make_problem(3, 4, 200, 7, 0.0, 9);
  const std::size_t count = problem.observations.size();
  for (std::size_t i = 0; i < count; i += 5) {
    BundleProblem::Observation again = problem.observations[i];
    again.x += 0.7f;
    problem.observations.push_back(again);
  }
  expect_agreement(problem, "two observations by one pose");
}

PoseGraphProblem random_graph(std::uint64_t seed) {
  Random random(seed);
  PoseGraphProblem problem;
  for (std::uint32_t i = 0; i < 50; ++i) {
    const Eigen::Isometry3d truth = geometry::exp_se3(synthetic::tangent(random, 2.0, 0.6));
    problem.nodes.push_back({geometry::exp_se3(synthetic::tangent(random, 0.1, 0.05)) * truth, i == 7});
    for (std::uint32_t k = 0; k < std::min(i, 3u); ++k) {
      const auto other = random.below(i);
      const Eigen::Isometry3d measured = geometry::exp_se3(synthetic::tangent(random, 0.02, 0.02)) *
                                         problem.nodes[other].T_camera_world *
                                         problem.nodes[i].T_camera_world.inverse();
      problem.edges.push_back({i, other, measured, 0.5 + 0.1 * k});
    }
  }
  problem.iterations = 100;
  return problem;
}

void expect_agreement(PoseGraphProblem problem) {
  PoseGraphProblem reference = problem;
  const GraphSummary expected = make_optimizer("ceres", {{"function_tolerance", 0.0}})->optimize_pose_graph(reference);
  const GraphSummary found = make_optimizer("schur", {{"graph_tolerance", 0.0}})->optimize_pose_graph(problem);
  ASSERT_TRUE(expected.usable && found.usable);
  EXPECT_NEAR(found.initial_cost, expected.initial_cost, 1e-9 * expected.initial_cost);
  EXPECT_NEAR(found.final_cost, expected.final_cost, 1e-6 * expected.final_cost);
  for (std::size_t i = 0; i < problem.nodes.size(); ++i)
    EXPECT_LT(synthetic::distance(problem.nodes[i].T_camera_world, reference.nodes[i].T_camera_world), 1e-6) << i;
}

TEST(SchurAgreesWithCeres, OnPoseGraphs) { expect_agreement(random_graph(10)); }

TEST(SchurAgreesWithCeres, OnPoseGraphsWithAVertical) {
  PoseGraphProblem problem = random_graph(12);
  problem.vertical = Eigen::Vector3d(0.4, -9.7, 1.1);
  expect_agreement(problem);
}

/// With its default tolerances it ends well within the uncertainty of the poses. The costs differ more, because a few
/// observations at the limit are outliers to the one and not to the other.
TEST(SchurAgreesWithCeres, NearlyWithDefaultTolerances) {
  BundleProblem problem = make_problem(4, 6, 300, 8, 0.05, 11), reference = problem;
  const BundleSummary found = make_optimizer("schur")->optimize_bundle(problem, go_on);
  reference.robust_iterations = reference.final_iterations = 200;
  reference.function_tolerance = 1e-14;
  const BundleSummary expected = make_optimizer("ceres")->optimize_bundle(reference, go_on);
  EXPECT_LE(found.iterations, 6);
  EXPECT_NEAR(found.final_cost, expected.final_cost, 0.03 * expected.final_cost);
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    EXPECT_LT(synthetic::distance(problem.poses[i].T_camera_world, reference.poses[i].T_camera_world), 1e-3) << i;
}

}  // namespace
}  // namespace holdfast
