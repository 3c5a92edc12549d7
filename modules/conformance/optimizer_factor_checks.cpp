// SPDX-License-Identifier: BSD-3-Clause
#include "optimizer_factor_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "check.hpp"
#include "inertial_problem.hpp"
#include "optimizer_problems.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/optimizer.hpp";
const char* const factors_header = "holdfast/interfaces/bundle_factors.hpp";
constexpr double nan_double = std::numeric_limits<double>::quiet_NaN();
const std::atomic<bool> go_on = false;

const Camera& camera() {
  static const Camera camera = standard_camera();
  return camera;
}

BundleProblem converging(BundleProblem problem) {
  problem.robust_iterations = 20;
  problem.final_iterations = 30;
  problem.function_tolerance = 1e-12;
  return problem;
}

/// Solves a problem that must not be usable and checks that nothing changed.
void expect_refused(Optimizer& optimizer, BundleProblem problem, const std::string& what) {
  const BundleProblem before = problem;
  EXPECT_FALSE(optimizer.optimize_bundle(problem, go_on).usable) << what;
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    EXPECT_EQ(problem.poses[i].T_camera_world.matrix(), before.poses[i].T_camera_world.matrix())
        << what << ": pose " << i << " changed";
  for (std::size_t i = 0; i < problem.factors.motions.size(); ++i) {
    const Eigen::Vector3d &is = problem.factors.motions[i].velocity, &was = before.factors.motions[i].velocity;
    EXPECT_TRUE(is == was || was.hasNaN()) << what << ": motion " << i << " changed";
  }
}

void solves_an_inertial_bundle(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  KnownInertial known = known_inertial(camera());
  if (!optimizer->supports(FactorKind::inertial))
    return expect_refused(*optimizer, known.problem, "inertial factors that supports() denies");
  BundleProblem problem = converging(known.problem);
  const BundleSummary summary = optimizer->optimize_bundle(problem, go_on);
  ASSERT_TRUE(summary.usable) << "exact observations and inertial measurements";
  EXPECT_LT(summary.final_cost, 0.01 * summary.initial_cost) << "the cost at the exact solution is almost 0";
  for (std::uint32_t i = 0; i < known.poses.size(); ++i) {
    const bool is_hidden = i >= first_hidden_pose && i <= last_hidden_pose;
    EXPECT_LT(distance(problem.poses[i].T_camera_world, known.poses[i]), 0.004)
        << "pose " << i << (is_hidden ? ", in which nothing is visible" : "");
    EXPECT_LT((problem.factors.motions[i].velocity - known.velocities[i]).norm(), 0.02) << "velocity " << i;
    EXPECT_LT((problem.factors.motions[i].bias.gyroscope - known.bias.gyroscope).norm(), 0.004) << "bias " << i;
  }
  EXPECT_LT((problem.factors.gravity - known.gravity).norm(), 0.1) << "gravity";
  EXPECT_NEAR(problem.factors.gravity.norm(), standard_gravity, 1e-9) << "the magnitude of gravity is known";
  EXPECT_EQ(problem.factors.scale, 1.0) << "the scale is fixed";
}

void estimates_a_free_scale(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->supports(FactorKind::inertial)) return;
  KnownInertial known = known_inertial(camera(), 2, 2.0);
  BundleProblem problem = converging(known.problem);
  problem.factors.scale = 1.9;
  problem.factors.scale_fixed = false;
  ASSERT_TRUE(optimizer->optimize_bundle(problem, go_on).usable);
  EXPECT_NEAR(problem.factors.scale, 2.0, 0.02) << "metres in a unit of the map";
}

void keeps_fixed_motions(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->supports(FactorKind::inertial)) return;
  KnownInertial known = known_inertial(camera(), 3);
  BundleProblem problem = converging(known.problem);
  problem.factors.gravity_fixed = true;
  problem.factors.motions[0].fixed = true;
  ASSERT_TRUE(optimizer->optimize_bundle(problem, go_on).usable);
  EXPECT_EQ(problem.factors.motions[0].velocity, known.problem.factors.motions[0].velocity) << "a fixed motion moved";
  EXPECT_EQ(problem.factors.gravity, known.problem.factors.gravity) << "fixed gravity moved";
  EXPECT_NE(problem.factors.motions[1].velocity, known.problem.factors.motions[1].velocity) << "a free motion did not";
}

/// Two poses, one with a prior, and their relative pose: the solution is exact. The prior of a motion that nothing else
/// determines is its solution.
void solves_relative_poses_and_priors(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->supports(FactorKind::relative_pose) || !optimizer->supports(FactorKind::prior)) return;
  const KnownGraph graph = known_graph();
  BundleProblem problem;
  problem.camera = &camera();
  for (const std::size_t i : {1U, 2U}) problem.poses.push_back({graph.problem.nodes[i].T_camera_world, false});
  problem.factors.pose_priors.push_back({.pose = 0, .T_camera_world = graph.poses[1]});
  problem.factors.relative_poses.push_back({.from = 0, .to = 1, .T_to_from = graph.problem.edges[1].T_to_from});
  problem.factors.motions.push_back({.pose = 1, .bias = {}});
  const Eigen::Vector3d velocity(0.3, -0.2, 0.1);
  problem.factors.motion_priors.push_back({.motion = 0, .velocity = velocity, .bias = {}});
  problem = converging(problem);
  ASSERT_TRUE(optimizer->optimize_bundle(problem, go_on).usable) << "no observation, but priors";
  for (const std::size_t i : {0U, 1U})
    EXPECT_LT(distance(problem.poses[i].T_camera_world, graph.poses[i + 1]), 1e-5) << "pose " << i;
  EXPECT_LT((problem.factors.motions[0].velocity - velocity).norm(), 1e-5) << "the prior of a motion";
}

void leaves_factors_that_cannot_be_used(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->supports(FactorKind::inertial)) return;
  const BundleProblem sound = known_inertial(camera(), 4).problem;
  BundleProblem nothing = sound;
  nothing.observations.clear();
  nothing.factors.inertial.clear();
  expect_refused(*optimizer, nothing, "motions without a factor, and no observation");
  BundleProblem velocity = sound;
  velocity.factors.motions[2].velocity.x() = nan_double;
  expect_refused(*optimizer, velocity, "a velocity is NaN");
  BundleProblem measured = sound;
  measured.factors.inertial[1].measured.integrate(Eigen::Vector3d(nan_double, 0, 0), Eigen::Vector3d::Zero(), 0.01);
  expect_refused(*optimizer, measured, "a measurement is NaN");
  BundleProblem empty = sound;
  empty.factors.inertial[1].measured = geometry::Preintegration();
  expect_refused(*optimizer, empty, "a factor without measurements, whose covariance is zero");
  BundleProblem negative = sound;
  negative.factors.pose_priors.push_back({.pose = 1, .information = -geometry::Matrix6d::Identity()});
  expect_refused(*optimizer, negative, "a negative information matrix");
  BundleProblem fixed = sound;
  for (BundleProblem::Pose& pose : fixed.poses) pose.fixed = true;
  for (BundleFactors::Motion& motion : fixed.factors.motions) motion.fixed = true;
  expect_refused(*optimizer, fixed, "nothing is free");
}

void same_factors_same_bits(const Maker& maker) {
  const auto optimizer = maker.make<Optimizer>();
  if (!optimizer->supports(FactorKind::inertial)) return;
  BundleProblem first = known_inertial(camera(), 5).problem, second = first,
                other = known_inertial(camera(), 6).problem;
  optimizer->optimize_bundle(first, go_on);
  optimizer->optimize_bundle(other, go_on);
  optimizer->optimize_bundle(second, go_on);
  for (std::size_t i = 0; i < first.poses.size(); ++i)
    EXPECT_EQ(first.poses[i].T_camera_world.matrix(), second.poses[i].T_camera_world.matrix()) << "pose " << i;
  for (std::size_t i = 0; i < first.factors.motions.size(); ++i)
    EXPECT_EQ(first.factors.motions[i].velocity, second.factors.motions[i].velocity) << "motion " << i;
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(first.factors.gravity, second.factors.gravity);
}

}  // namespace

std::vector<Check> optimizer_factor_checks() {
  const Promise inertial{
      factors_header,
      "Preintegrated measurements from one motion to another (indices into `motions`), with the random walk of the "
      "biases (Forster et al. 2017, equations 45 to 48)."};
  return {
      {"SolvesAnInertialBundle", inertial, solves_an_inertial_bundle},
      {"EstimatesAFreeScale",
       {factors_header, "metres in a unit of the map; in and out, unless it is fixed"},
       estimates_a_free_scale},
      {"KeepsFixedMotions",
       {factors_header,
        "Acceleration in the world frame, points down [m/s^2]; in and out: its direction, unless it is "
        "fixed."},
       keeps_fixed_motions},
      {"SolvesRelativePosesAndPriors",
       {factors_header, "Prior of a motion (index into `motions`); residual: the difference."},
       solves_relative_poses_and_priors},
      {"LeavesFactorsThatCannotBeUsed", {header, "false: nothing was changed"}, leaves_factors_that_cannot_be_used},
      {"SameFactorsSameBits",
       {header, "With CreationContext::sequential the results are bit-identical from run to run."},
       same_factors_same_bits},
  };
}

}  // namespace holdfast::conformance
