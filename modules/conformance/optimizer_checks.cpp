// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "check.hpp"
#include "optimizer_factor_checks.hpp"
#include "optimizer_problems.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/optimizer.hpp";
const char* const pose_header = "holdfast/geometry/pose_problem.hpp";
constexpr double near_truth = 2e-3;  // m plus rad; measurements are floats
constexpr float nan_float = std::numeric_limits<float>::quiet_NaN();
constexpr double nan_double = std::numeric_limits<double>::quiet_NaN();

const Camera& camera() {
  static const Camera camera = standard_camera();
  return camera;
}
const std::atomic<bool> go_on = false;

bool same_bits(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return a.matrix() == b.matrix(); }

bool same_bits(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

template <class Items, class Pose>
bool same_poses(const Items& a, const Items& b, Pose pose_of) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [&](const auto& x, const auto& y) {
           return same_bits(pose_of(x), pose_of(y)) && x.fixed == y.fixed;
         });
}
const auto pose_of = [](const auto& each) { return each.T_camera_world; };

bool same_bits(const BundleProblem& a, const BundleProblem& b) {
  return same_poses(a.poses, b.poses, pose_of) && same_bits(a.points, b.points) &&
         std::equal(a.observations.begin(), a.observations.end(), b.observations.begin(), b.observations.end(),
                    [](const auto& x, const auto& y) { return x.outlier == y.outlier; });
}

// ---- one pose

void finds_a_pose(const Maker& maker) {
  KnownPose known = known_pose(camera());
  const PoseSummary summary = maker.make<Optimizer>()->optimize_pose(known.problem);
  ASSERT_TRUE(summary.usable) << "60 exact observations, and a first guess near by";
  EXPECT_TRUE(is_rigid(known.problem.T_camera_world)) << "the result is no rotation and translation";
  EXPECT_LT(distance(known.problem.T_camera_world, known.truth), near_truth) << "m + rad away from the exact pose";
  EXPECT_EQ(summary.inliers, 60) << "all observations are exact";
  EXPECT_TRUE(std::isfinite(summary.final_cost) && summary.final_cost >= 0.0) << "final_cost " << summary.final_cost;
  EXPECT_GE(summary.iterations, 0);
}

void marks_inliers_of_a_pose(const Maker& maker) {
  KnownPose known = known_pose(camera());
  for (std::size_t i = 5; i < 60; i += 10) known.problem.x[i] += 40.0F;
  known.problem.inlier.assign(7, 1);  // what was there before does not count
  const PoseSummary summary = maker.make<Optimizer>()->optimize_pose(known.problem);
  ASSERT_TRUE(summary.usable) << "54 exact observations of 60";
  ASSERT_EQ(known.problem.inlier.size(), 60U) << "inlier has another length than the observations";
  for (std::size_t i = 0; i < 60; ++i)
    EXPECT_EQ(static_cast<int>(known.problem.inlier[i]), i % 10 == 5 ? 0 : 1)
        << "observation " << i << (i % 10 == 5 ? " is off by 40 px" : " is exact");
  EXPECT_EQ(summary.inliers, 54) << "the summary's count of inliers";
  EXPECT_LT(distance(known.problem.T_camera_world, known.truth), near_truth) << "outliers pulled the pose away";
}

void leaves_out_what_has_no_weight(const Maker& maker) {
  KnownPose known = known_pose(camera());
  for (std::size_t i = 0; i < 60; i += 2) {
    known.problem.weight[i] = 0.0F;
    known.problem.x[i] += 2.0F;  // all the same way: as many as the others, and within the chi-square test
  }
  const PoseSummary summary = maker.make<Optimizer>()->optimize_pose(known.problem);
  ASSERT_TRUE(summary.usable) << "30 exact observations of weight 1";
  EXPECT_LT(distance(known.problem.T_camera_world, known.truth), near_truth) << "observations of weight 0 counted";
}

void covariance_is_one(const Maker& maker) {
  KnownPose known = known_pose(camera());
  const PoseSummary summary = maker.make<Optimizer>()->optimize_pose(known.problem);
  ASSERT_TRUE(summary.covariance.allFinite()) << summary.covariance;
  EXPECT_LT((summary.covariance - summary.covariance.transpose()).norm(), 1e-9 + 1e-6 * summary.covariance.norm())
      << "the covariance is not symmetric";
  EXPECT_GT(summary.covariance.diagonal().minCoeff(), 0.0) << "a variance is not positive";
}

void leaves_a_pose_that_cannot_be_found(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  for (const std::size_t points : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    PoseProblem problem = known_pose(camera(), points).problem;
    const Eigen::Isometry3d before = problem.T_camera_world;
    EXPECT_FALSE(optimizer->optimize_pose(problem).usable) << points << " observations give no pose";
    EXPECT_TRUE(same_bits(problem.T_camera_world, before)) << "the pose changed with " << points << " observations";
  }
}

void survives_numbers_that_are_none(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  KnownPose known = known_pose(camera());
  known.problem.points[3].x() = nan_double;
  known.problem.x[8] = nan_float;
  known.problem.y[12] = std::numeric_limits<float>::infinity();
  known.problem.inverse_sigma2[20] = nan_float;
  const PoseSummary summary = optimizer->optimize_pose(known.problem);
  EXPECT_TRUE(known.problem.T_camera_world.matrix().allFinite()) << "NaN in observations reached the pose";
  if (summary.usable) {
    ASSERT_EQ(known.problem.inlier.size(), 60U);
    for (const std::size_t i : {3U, 8U, 12U, 20U})
      EXPECT_EQ(static_cast<int>(known.problem.inlier[i]), 0) << "observation " << i << " is no number";
  }
  PoseProblem bad = known_pose(camera()).problem;
  bad.T_camera_world.translation().x() = nan_double;
  EXPECT_FALSE(optimizer->optimize_pose(bad).usable) << "the first guess is NaN";

  KnownBundle bundle = known_bundle(camera());
  bundle.problem.observations[200].x = nan_float;
  bundle.problem.observations[300].weight = nan_float;
  optimizer->optimize_bundle(bundle.problem, go_on);
  for (const BundleProblem::Pose& pose : bundle.problem.poses)
    EXPECT_TRUE(pose.T_camera_world.matrix().allFinite()) << "NaN in an observation reached a pose of a bundle";
  for (const Eigen::Vector3d& point : bundle.problem.points)
    EXPECT_TRUE(point.allFinite()) << "NaN in an observation reached a point of a bundle";

  KnownGraph graph = known_graph();
  graph.problem.edges[2].T_to_from.translation().y() = nan_double;
  optimizer->optimize_pose_graph(graph.problem);
  for (const PoseGraphProblem::Node& node : graph.problem.nodes)
    EXPECT_TRUE(node.T_camera_world.matrix().allFinite()) << "NaN in an edge reached a node of a graph";
}

void leaves_what_is_not_out(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  PoseProblem pose = known_pose(camera()).problem;
  pose.weight[4] = 0.5F;
  const PoseProblem pose_before = pose;
  optimizer->optimize_pose(pose);
  EXPECT_TRUE(same_bits(pose.points, pose_before.points) && pose.x == pose_before.x && pose.y == pose_before.y &&
              pose.inverse_sigma2 == pose_before.inverse_sigma2 && pose.weight == pose_before.weight)
      << "optimize_pose wrote to the observations";
  BundleProblem bundle = known_bundle(camera()).problem;
  const BundleProblem bundle_before = bundle;
  optimizer->optimize_bundle(bundle, go_on);
  ASSERT_EQ(bundle.observations.size(), bundle_before.observations.size()) << "observations were added or removed";
  for (std::size_t i = 0; i < bundle.observations.size(); ++i) {
    const auto &is = bundle.observations[i], &was = bundle_before.observations[i];
    ASSERT_TRUE(is.pose == was.pose && is.point == was.point && is.x == was.x && is.y == was.y &&
                is.weight == was.weight && is.inverse_sigma2 == was.inverse_sigma2)
        << "optimize_bundle wrote to observation " << i;
  }
}

// ---- bundles

void solves_a_bundle(const Maker& maker) {
  KnownBundle known = known_bundle(camera());
  const BundleSummary summary = maker.make<Optimizer>()->optimize_bundle(known.problem, go_on);
  ASSERT_TRUE(summary.usable) << "exact observations, first guesses near by, two fixed poses";
  EXPECT_FALSE(summary.stopped) << "nobody raised the flag";
  EXPECT_LE(summary.final_cost, summary.initial_cost) << "the cost grew";
  EXPECT_EQ(summary.outliers, 0) << "all observations are exact";
  for (std::size_t i = 0; i < known.poses.size(); ++i) {
    EXPECT_TRUE(is_rigid(known.problem.poses[i].T_camera_world)) << "pose " << i;
    EXPECT_LT(distance(known.problem.poses[i].T_camera_world, known.poses[i]), near_truth) << "pose " << i;
  }
  for (std::size_t i = 0; i < known.points.size(); ++i)
    EXPECT_LT((known.problem.points[i] - known.points[i]).norm(), 5 * near_truth) << "point " << i;
}

void keeps_fixed_poses(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  KnownBundle bundle = known_bundle(camera());
  optimizer->optimize_bundle(bundle.problem, go_on);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(same_bits(bundle.problem.poses[i].T_camera_world, bundle.poses[i])) << "fixed pose " << i << " moved";
  KnownGraph graph = known_graph();
  optimizer->optimize_pose_graph(graph.problem);
  EXPECT_TRUE(same_bits(graph.problem.nodes[0].T_camera_world, graph.poses[0])) << "the fixed node moved";
}

void marks_outliers_of_a_bundle(const Maker& maker) {
  KnownBundle known = known_bundle(camera());
  for (const std::size_t i : {100U, 250U, 400U}) known.problem.observations[i].y += 60.0F;
  known.problem.observations[7].outlier = true;  // what was there before does not count
  const BundleSummary summary = maker.make<Optimizer>()->optimize_bundle(known.problem, go_on);
  ASSERT_TRUE(summary.usable);
  for (std::size_t i = 0; i < known.problem.observations.size(); ++i)
    EXPECT_EQ(known.problem.observations[i].outlier, i == 100 || i == 250 || i == 400) << "observation " << i;
  EXPECT_EQ(summary.outliers, 3) << "the summary's count of outliers";
}

void stops_a_bundle(const Maker& maker) {
  const std::atomic<bool> stop = true;
  BundleProblem problem = known_bundle(camera()).problem;
  const BundleProblem before = problem;
  const BundleSummary summary = maker.make<Optimizer>()->optimize_bundle(problem, stop);
  EXPECT_TRUE(summary.stopped) << "the flag was up from the beginning";
  EXPECT_LE(summary.iterations, 2) << "iterations with the flag up";
  for (const BundleProblem::Pose& pose : problem.poses) EXPECT_TRUE(is_rigid(pose.T_camera_world));
  if (!summary.usable) {
    EXPECT_TRUE(same_bits(problem, before)) << "not usable, but something was changed";
  }
}

void leaves_a_bundle_that_cannot_be_solved(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  const auto expect_left = [&](BundleProblem problem, const std::string& what) {
    const BundleProblem before = problem;
    const BundleSummary summary = optimizer->optimize_bundle(problem, go_on);
    if (!summary.usable) {
      EXPECT_TRUE(same_bits(problem, before)) << what << ": not usable, but something was changed";
    }
    for (const BundleProblem::Pose& pose : problem.poses)
      EXPECT_TRUE(pose.T_camera_world.matrix().allFinite()) << what << ": a pose is not finite";
  };
  BundleProblem empty;
  empty.camera = &camera();
  EXPECT_FALSE(optimizer->optimize_bundle(empty, go_on).usable) << "a problem without poses, points and observations";
  BundleProblem unseen = known_bundle(camera()).problem;
  unseen.observations.clear();
  EXPECT_FALSE(optimizer->optimize_bundle(unseen, go_on).usable) << "a problem without observations";
  expect_left(unseen, "without observations");
  BundleProblem fixed = known_bundle(camera()).problem;
  for (BundleProblem::Pose& pose : fixed.poses) pose.fixed = true;
  expect_left(fixed, "with every pose fixed");
  BundleProblem single = known_bundle(camera()).problem;
  single.observations.resize(1);
  expect_left(single, "with one observation");
  BundleProblem weightless = known_bundle(camera()).problem;
  for (BundleProblem::Observation& observation : weightless.observations) observation.weight = 0.0F;
  expect_left(weightless, "with every weight 0");
}

// ---- pose graphs

void solves_a_graph(const Maker& maker) {
  KnownGraph known = known_graph();
  const GraphSummary summary = maker.make<Optimizer>()->optimize_pose_graph(known.problem);
  ASSERT_TRUE(summary.usable) << "exact edges, a fixed node";
  EXPECT_LE(summary.final_cost, summary.initial_cost) << "the cost grew";
  for (std::size_t i = 0; i < known.poses.size(); ++i) {
    EXPECT_TRUE(is_rigid(known.problem.nodes[i].T_camera_world)) << "node " << i;
    EXPECT_LT(distance(known.problem.nodes[i].T_camera_world, known.poses[i]), near_truth) << "node " << i;
  }
}

/// Nodes begin with wrong positions and yaws. Edges are exact, or the one that closes the circle has a tilt.
void keeps_the_vertical(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->keeps_vertical()) return;
  const Eigen::Vector3d down = Eigen::Vector3d(0.2, 9.7, -0.4);
  for (const bool has_scale : {false, true}) {
    for (const bool has_tilt : {false, true}) {
      KnownGraph known = known_graph();
      PoseGraphProblem& problem = known.problem;
      for (std::size_t i = 1; i < problem.nodes.size(); ++i)
        problem.nodes[i].T_camera_world =
            Eigen::Translation3d(0.1, 0.05, -0.1) * known.poses[i] * Eigen::AngleAxisd(0.15, down.normalized());
      if (has_tilt)
        problem.edges.back().T_to_from =
            problem.edges.back().T_to_from * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX());
      problem.vertical = down;
      const GraphSummary summary =
          has_scale ? optimizer->optimize_similarity_graph(problem) : optimizer->optimize_pose_graph(problem);
      ASSERT_TRUE(summary.usable) << "a fixed node, and a vertical";
      EXPECT_LT(summary.final_cost, 0.9 * summary.initial_cost) << "positions were not adjusted";
      for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        const Eigen::Matrix3d R = problem.nodes[i].T_camera_world.linear();
        EXPECT_LT((R * down - known.poses[i].linear() * down).norm(), 1e-9) << "node " << i << " tilted";
        EXPECT_LT((R - known.poses[i].linear()).norm(), has_tilt ? 0.2 : near_truth) << "yaw of node " << i;
      }
    }
  }
}

void leaves_a_graph_that_cannot_be_solved(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  PoseGraphProblem empty;
  EXPECT_FALSE(optimizer->optimize_pose_graph(empty).usable) << "a graph without nodes";
  PoseGraphProblem loose = known_graph().problem;
  loose.edges.clear();
  const PoseGraphProblem before = loose;
  optimizer->optimize_pose_graph(loose);
  EXPECT_TRUE(same_poses(loose.nodes, before.nodes, pose_of)) << "nodes without edges moved";
}

// ---- threads and repetition

/// All three problems solved, for comparisons.
struct Solved {
  PoseProblem pose;
  BundleProblem bundle;
  PoseGraphProblem graph;
};
Solved solve(Optimizer& optimizer, std::uint64_t seed) {
  Solved solved{known_pose(camera(), 60, seed).problem, known_bundle(camera(), seed).problem,
                known_graph(seed).problem};
  optimizer.optimize_pose(solved.pose);
  optimizer.optimize_bundle(solved.bundle, go_on);
  optimizer.optimize_pose_graph(solved.graph);
  return solved;
}
void expect_same(const Solved& a, const Solved& b, const std::string& when) {
  EXPECT_TRUE(same_bits(a.pose.T_camera_world, b.pose.T_camera_world) && a.pose.inlier == b.pose.inlier)
      << when << ": another pose";
  EXPECT_TRUE(same_bits(a.bundle, b.bundle)) << when << ": another bundle";
  EXPECT_TRUE(same_poses(a.graph.nodes, b.graph.nodes, pose_of)) << when << ": another pose graph";
}

void same_problem_same_bits(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  const Solved first = solve(*optimizer, 1);
  solve(*optimizer, 2);
  expect_same(first, solve(*optimizer, 1), "on a second call");
  expect_same(first, solve(*maker.make<Optimizer>(), 1), "by a second instance");
}

void many_threads_at_once(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  std::vector<Solved> alone, together(6);
  for (std::uint64_t seed = 0; seed < 6; ++seed) alone.push_back(solve(*maker.make<Optimizer>(), seed));
  const auto solve_some = [&](std::size_t begin) {
    for (std::size_t i = begin; i < together.size(); i += 2) together[i] = solve(*optimizer, i);
  };
  run_side_by_side([&] { solve_some(0); }, [&] { solve_some(1); });
  for (std::size_t i = 0; i < alone.size(); ++i)
    expect_same(alone[i], together[i], "one instance called by two threads at once");
}

void instances_do_not_meet(const Maker& maker) {
  const auto one = maker.make<Optimizer>(), two = maker.make<Optimizer>();
  const Solved alone = solve(*one, 3);
  Solved first, second;
  run_side_by_side([&] { first = solve(*one, 3); }, [&] { second = solve(*two, 3); });
  expect_same(alone, first, "beside another instance in another thread");
  expect_same(alone, second, "beside another instance in another thread");
}

void time(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  report_time("optimizer/" + maker.entry().description.name + ", pose of 300 observations", 9, [&] {
    KnownPose known = known_pose(camera(), 300);
    optimizer->optimize_pose(known.problem);
  });
  report_time("optimizer/" + maker.entry().description.name + ", bundle of 450 observations", 5, [&] {
    KnownBundle known = known_bundle(camera());
    optimizer->optimize_bundle(known.problem, go_on);
  });
}

}  // namespace

std::vector<Check> optimizer_checks() {
  const Promise pose{header, "in: first guess; out: the result"};
  const Promise bundle{
      header,
      "Poses and points together: local and full bundle adjustment (Mur-Artal and Tardos 2017, section "
      "III-C); with factors a visual-inertial one"};
  const Promise unchanged{header, "false: nothing was changed"};
  const Promise threads{header, "Any method may be called by several threads at once, each with a problem of its own."};
  std::vector<Check> checks = {
      {"FindsAPose", pose, finds_a_pose},
      {"MarksInliersOfAPose", {header, "out: 1 where the final chi-square test passed"}, marks_inliers_of_a_pose},
      {"LeavesOutWhatHasNoWeight",
       {header,
        "Residual: undistorted pixel and, where there is depth, column in the virtual right image, minus the "
        "projection of the point; weighted by inverse_sigma2 * weight."},
       leaves_out_what_has_no_weight},
      {"CovarianceIsOne",
       {pose_header,
        "Inverse of the approximated Hessian at the result: covariance of a left perturbation (translation, "
        "rotation)."},
       covariance_is_one},
      {"LeavesAPoseThatCannotBeFound",
       {pose_header, "false: too few observations or no finite solution; T_camera_world is unchanged then"},
       leaves_a_pose_that_cannot_be_found},
      {"SolvesABundle", bundle, solves_a_bundle},
      {"KeepsFixedPoses", bundle, keeps_fixed_poses},
      {"MarksOutliersOfABundle", {header, "without it, on what is left; 0 = skip"}, marks_outliers_of_a_bundle},
      {"StopsABundle",
       {header, "the stop flag ended it early; the best state so far is in the problem"},
       stops_a_bundle},
      {"LeavesABundleThatCannotBeSolved", unchanged, leaves_a_bundle_that_cannot_be_solved},
      {"SolvesAGraph",
       {header, "Keyframe poses linked by relative poses (Mur-Artal and Tardos 2017, section III-D)."},
       solves_a_graph},
      {"KeepsTheVertical",
       {header, "Whether both functions for pose graphs obey PoseGraphProblem::vertical; others ignore it."},
       keeps_the_vertical},
      {"LeavesAGraphThatCannotBeSolved", unchanged, leaves_a_graph_that_cannot_be_solved},
      {"SurvivesNumbersThatAreNone",
       {header,
        "Numbers that are not finite in an observation, a factor or an edge make it an outlier or the problem "
        "unusable, "
        "never a pose or point that is not finite."},
       survives_numbers_that_are_none},
      {"LeavesWhatIsNotOut", {header, "What is not marked `out` is not written to."}, leaves_what_is_not_out},
      {"SameProblemSameBits",
       {header, "With CreationContext::sequential the results are bit-identical from run to run."},
       same_problem_same_bits},
      {"ManyThreadsAtOnce", threads, many_threads_at_once},
      {"InstancesDoNotMeet", threads, instances_do_not_meet},
      {"Time", threads, time},
  };
  const std::vector<Check> of_factors = optimizer_factor_checks();
  checks.insert(checks.end(), of_factors.begin(), of_factors.end());
  return checks;
}

}  // namespace holdfast::conformance
