// SPDX-License-Identifier: BSD-3-Clause
// Factors of bundle problems: derivatives against differences, `schur` against the reference `ceres`.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "agreement.hpp"
#include "ceres/factor_cost.hpp"
#include "geometry/synthetic.hpp"
#include "holdfast/geometry/relative_pose.hpp"
#include "inertial_problem.hpp"

namespace holdfast {
namespace {

using conformance::KnownInertial;

const std::atomic<bool> go_on = false;
const Camera camera = synthetic::camera();

geometry::Matrix6d some_information(Random& random) {
  geometry::Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = random.normal();
  return root.transpose() * root + geometry::Matrix6d::Identity();
}

/// Inertial factors, a relative pose and priors, all with residuals far from zero.
BundleProblem problem_of_all_kinds(std::uint64_t seed) {
  Random random(seed);
  BundleProblem problem = conformance::known_inertial(camera, seed, 1.3).problem;
  BundleFactors& factors = problem.factors;
  factors.scale_fixed = false;
  for (BundleProblem::Pose& pose : problem.poses)
    pose.T_camera_world = geometry::exp_se3(synthetic::tangent(random, 0.2, 0.3)) * pose.T_camera_world;
  factors.relative_poses.push_back(
      {2, 5, geometry::exp_se3(synthetic::tangent(random, 0.5, 0.5)), some_information(random)});
  factors.pose_priors.push_back({6, geometry::exp_se3(synthetic::tangent(random, 0.5, 0.5)), some_information(random)});
  BundleFactors::MotionPrior prior{.motion = 4, .velocity = {0.1, 0.2, 0.3}, .bias = {}};
  prior.information.diagonal().setLinSpaced(0.0, 4.0);  // the first number is unknown
  factors.motion_priors.push_back(prior);
  return problem;
}

using Column = Eigen::Matrix<double, 15, 1>;

/// Numeric derivative of the residual by the number that `change` adds to.
Column difference(const FactorEvaluation& evaluation, const FactorEvaluation::Factor& factor,
                  const FactorEvaluation::States& states,
                  const std::function<void(FactorEvaluation::States&, double)>& change) {
  constexpr double h = 1e-6;
  FactorError plus, minus;
  FactorEvaluation::States moved = states;
  change(moved, h);
  evaluation.evaluate(factor, moved, false, plus);
  moved = states;
  change(moved, -h);
  evaluation.evaluate(factor, moved, false, minus);
  Column result = Column::Zero();
  result.head(factor.rows) = (plus.residual - minus.residual).head(factor.rows) / (2 * h);
  return result;
}

void expect_near(const Eigen::Ref<const Eigen::MatrixXd>& analytic, const Column& numeric, int rows,
                 const std::string& what) {
  const double size = 1.0 + numeric.head(rows).norm();
  EXPECT_LT((analytic.topRows(rows) - numeric.head(rows)).norm(), 1e-5 * size) << what;
}

TEST(FactorEvaluation, DerivativesAgreeWithDifferences) {
  const BundleProblem problem = problem_of_all_kinds(1);
  const FactorEvaluation evaluation(problem);
  FactorEvaluation::States states = evaluation.states();
  states.world = Eigen::Vector3d(0.1, -0.2, 0.15);  // away from where the tangents were chosen
  ASSERT_TRUE(evaluation.is_finite());
  ASSERT_EQ(evaluation.factors().size(), problem.factors.inertial.size() + 3);
  for (const FactorEvaluation::Factor& factor : evaluation.factors()) {
    const std::string what = "kind " + std::to_string(static_cast<int>(factor.kind));
    FactorError error;
    evaluation.evaluate(factor, states, true, error);
    for (std::size_t i = 0; i < 2; ++i) {
      for (int k = 0; k < 6 && factor.poses[i] != FactorEvaluation::none; ++k) {
        const auto change = [&](FactorEvaluation::States& moved, double h) {
          Eigen::Isometry3d& pose = moved.poses[factor.poses[i]];
          pose = geometry::exp_se3(h * geometry::Vector6d::Unit(k)) * pose;
        };
        expect_near(error.by_pose[i].col(k), difference(evaluation, factor, states, change), factor.rows,
                    what + " pose " + std::to_string(k));
      }
      for (int k = 0; k < 9 && factor.motions[i] != FactorEvaluation::none; ++k) {
        const auto change = [&](FactorEvaluation::States& moved, double h) {
          moved.motions[factor.motions[i]][k] += h;
        };
        expect_near(error.by_motion[i].col(k), difference(evaluation, factor, states, change), factor.rows,
                    what + " motion " + std::to_string(k));
      }
    }
    for (int k = 0; k < 3 && factor.has_world; ++k) {
      const auto change = [&](FactorEvaluation::States& moved, double h) { moved.world[k] += h; };
      expect_near(error.by_world.col(k), difference(evaluation, factor, states, change), factor.rows,
                  what + " world " + std::to_string(k));
    }
  }
}

/// The cost of the only factor of a problem.
double cost_of(BundleProblem problem, const BundleFactors& factors) {
  problem.factors = factors;
  const FactorEvaluation evaluation(problem);
  return evaluation.cost(evaluation.states());
}

/// The cost is that of the information, half its squared Mahalanobis distance.
TEST(FactorEvaluation, WhitensByTheInformation) {
  const BundleProblem problem = problem_of_all_kinds(2);
  const auto pose = [&](std::uint32_t index) { return problem.poses[index].T_camera_world; };
  BundleFactors factors;
  const BundleFactors::PosePrior prior = problem.factors.pose_priors.front();
  factors.pose_priors = {prior};
  geometry::Vector6d residual = geometry::log_se3(pose(prior.pose) * prior.T_camera_world.inverse());
  double expected = 0.5 * residual.dot(prior.information * residual);
  EXPECT_NEAR(cost_of(problem, factors), expected, 1e-9 * expected) << "prior";

  factors = {};
  const BundleFactors::RelativePose relative = problem.factors.relative_poses.front();
  factors.relative_poses = {relative};
  residual = geometry::relative_pose_residual(relative.T_to_from.inverse(), pose(relative.from), pose(relative.to));
  expected = 0.5 * residual.dot(relative.information * residual);
  EXPECT_NEAR(cost_of(problem, factors), expected, 1e-9 * expected) << "relative pose";
}

TEST(FactorEvaluation, WhitensInertialFactorsByTheInverseOfTheirCovariance) {
  const BundleProblem problem = problem_of_all_kinds(2);
  BundleFactors factors = problem.factors;
  factors.relative_poses.clear(), factors.pose_priors.clear(), factors.motion_priors.clear();
  factors.inertial.resize(1);
  const BundleFactors::Inertial& inertial = factors.inertial.front();
  const auto state = [&](std::uint32_t index) {
    const BundleFactors::Motion& motion = factors.motions[index];
    Eigen::Isometry3d T_world_camera = problem.poses[motion.pose].T_camera_world.inverse();
    T_world_camera.translation() *= factors.scale;
    return geometry::InertialState{T_world_camera * factors.T_body_camera.inverse(), motion.velocity, motion.bias};
  };
  const geometry::Vector15d residual =
      inertial.measured.residual(state(inertial.first), state(inertial.second), factors.gravity);
  const Eigen::FullPivLU<geometry::Matrix15d> covariance(inertial.measured.covariance());
  const double expected = 0.5 * residual.dot(covariance.solve(residual));
  EXPECT_NEAR(cost_of(problem, factors), expected, 1e-6 * expected);
}

/// Ceres moves translation and rotation vector of a pose instead of a left perturbation.
TEST(FactorCost, JacobiansOfTheSolversParametersAgreeWithDifferences) {
  const BundleProblem problem = problem_of_all_kinds(3);
  const FactorEvaluation evaluation(problem);
  std::vector<ceres_plugin::PoseState> poses(problem.poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].set(problem.poses[i].T_camera_world);
  for (ceres_plugin::PoseState& pose : poses) {
    const double moved[6] = {0.1, -0.2, 0.3, 0.4, -0.3, 0.2};
    for (int k = 0; k < 6; ++k) pose.parameters[k] += moved[k];
    pose.update();
  }
  ceres_plugin::FactorParameters parameters;
  parameters.states = evaluation.states();
  parameters.motions = parameters.states.motions;
  parameters.update(poses);
  const FactorEvaluation::Factor& factor = evaluation.factors()[2];
  const ceres_plugin::FactorCost cost(evaluation, factor, parameters.states, poses, {true, false, false, true, false});
  ASSERT_EQ(cost.parameter_block_sizes(), (std::vector<int>{6, 9}));
  Eigen::Matrix<double, 15, 6, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> by_motion;
  double* jacobians[2] = {by_pose.data(), by_motion.data()};
  Column residual, plus, minus;
  ASSERT_TRUE(cost.Evaluate(nullptr, residual.data(), jacobians));
  const auto numeric = [&](double& number) {
    constexpr double h = 1e-6;
    const double before = number;
    const auto evaluate = [&](double value, Column& into) {
      number = value;
      poses[factor.poses[0]].update();
      parameters.update(poses);
      cost.Evaluate(nullptr, into.data(), nullptr);
    };
    evaluate(before + h, plus), evaluate(before - h, minus), evaluate(before, residual);
    return Column((plus - minus) / (2 * h));
  };
  for (int k = 0; k < 6; ++k)
    expect_near(by_pose.col(k), numeric(poses[factor.poses[0]].parameters[k]), 15, "pose " + std::to_string(k));
  for (int k = 0; k < 9; ++k)
    expect_near(by_motion.col(k), numeric(parameters.motions[factor.motions[1]][k]), 15, "motion " + std::to_string(k));
}

/// Measurements with noise, which leave residuals in every factor.
BundleProblem noisy_problem(std::uint64_t seed, bool with_scale) {
  Random random(seed);
  BundleProblem problem = conformance::known_inertial(camera, seed, with_scale ? 1.5 : 1.0).problem;
  problem.factors.scale_fixed = !with_scale;
  for (BundleProblem::Observation& observation : problem.observations) {
    observation.x += static_cast<float>(random.normal());
    observation.y += static_cast<float>(random.normal());
    observation.right_x += static_cast<float>(random.normal());
    if (random.uniform() < 0.03) observation.x += 40.0F;
  }
  problem.factors.relative_poses.push_back(
      {1, 6,
       geometry::exp_se3(synthetic::tangent(random, 0.01, 0.01)) * problem.poses[6].T_camera_world *
           problem.poses[1].T_camera_world.inverse(),
       1e4 * geometry::Matrix6d::Identity()});
  problem.factors.motion_priors.push_back({.motion = 0, .bias = {}});
  return problem;
}

void expect_agreement(BundleProblem problem, const std::string& what, std::int64_t dense_poses = 60) {
  BundleProblem reference;
  ASSERT_NO_FATAL_FAILURE(expect_same_solution(problem, reference, what, dense_poses, 1e-5));
  for (std::size_t i = 0; i < problem.factors.motions.size(); ++i) {
    const auto &is = problem.factors.motions[i], &should_be = reference.factors.motions[i];
    EXPECT_LT((is.velocity - should_be.velocity).norm(), 1e-5) << what << ", velocity " << i;
    EXPECT_LT((is.bias.accelerometer - should_be.bias.accelerometer).norm(), 1e-4) << what << ", bias " << i;
  }
  EXPECT_LT((problem.factors.gravity - reference.factors.gravity).norm(), 1e-4) << what;
  EXPECT_NEAR(problem.factors.scale, reference.factors.scale, 1e-5) << what;
}

TEST(SchurAgreesWithCeres, OnInertialProblems) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_agreement(noisy_problem(seed, false), "known scale");
  expect_agreement(noisy_problem(4, true), "free scale");
  expect_agreement(noisy_problem(5, false), "sparse visual part", 0);
}

TEST(SchurAgreesWithCeres, WithFixedMotionsAndFixedGravity) {
  BundleProblem problem = noisy_problem(6, false);
  problem.factors.gravity_fixed = true;
  problem.factors.motions[2].fixed = problem.poses[5].fixed = true;
  expect_agreement(problem, "fixed states");
}

TEST(SchurAgreesWithCeres, WithoutObservations) {
  BundleProblem problem = noisy_problem(7, false);
  problem.observations.clear();
  problem.factors.pose_priors.push_back({.pose = 7, .T_camera_world = problem.poses[7].T_camera_world});
  expect_agreement(problem, "factors alone");
}

/// Poses that are known, with motions and a world that are not, and the tolerance of the settings.
TEST(SchurAgreesWithCeres, WithFixedPosesAndTheToleranceOfTheSettings) {
  BundleProblem problem = noisy_problem(9, true);
  problem.factors.relative_poses.clear();
  const KnownInertial known = conformance::known_inertial(camera, 9, 1.5);
  for (std::size_t i = 0; i < problem.poses.size(); ++i) problem.poses[i] = {known.poses[i], true};
  problem.robust_iterations = problem.final_iterations = 100;
  BundleProblem reference = problem;
  reference.function_tolerance = 1e-14;
  const BundleSummary expected = make_optimizer("ceres")->optimize_bundle(reference, go_on);
  const BundleSummary found = make_optimizer("schur")->optimize_bundle(problem, go_on);
  ASSERT_TRUE(expected.usable && found.usable);
  EXPECT_NEAR(found.final_cost, expected.final_cost, 1e-3 * expected.final_cost + 1e-3);
  EXPECT_NEAR(problem.factors.scale, reference.factors.scale, 1e-3);
  EXPECT_LT((problem.factors.gravity - reference.factors.gravity).norm(), 1e-2);
}

/// Factors without a free state cost a visual problem nothing, to the last bit.
TEST(Factors, ThatLeaveEverythingFixedChangeNoBit) {
  for (const char* name : {"ceres", "schur"}) {
    BundleProblem plain = synthetic::bundle_case(camera, 4, 6, 300, 8, 1.0, 0.05, 8).problem;
    plain.poses[0].fixed = plain.poses[1].fixed = true;
    BundleProblem with_factors = plain;
    const BundleProblem other = problem_of_all_kinds(8);
    for (std::uint32_t i = 0; i < 2; ++i)
      with_factors.factors.motions.push_back({.pose = i, .bias = {}, .fixed = true});
    with_factors.factors.inertial.push_back({0, 1, other.factors.inertial.front().measured});
    with_factors.factors.pose_priors.push_back({0, other.poses[2].T_camera_world, geometry::Matrix6d::Identity()});
    ASSERT_FALSE(with_factors.factors.empty());
    ASSERT_TRUE(make_optimizer(name)->optimize_bundle(plain, go_on).usable) << name;
    ASSERT_TRUE(make_optimizer(name)->optimize_bundle(with_factors, go_on).usable) << name;
    for (std::size_t i = 0; i < plain.poses.size(); ++i)
      EXPECT_EQ(plain.poses[i].T_camera_world.matrix(), with_factors.poses[i].T_camera_world.matrix()) << name << i;
    EXPECT_EQ(plain.points, with_factors.points) << name;
    for (std::size_t i = 0; i < plain.observations.size(); ++i)
      EXPECT_EQ(plain.observations[i].outlier, with_factors.observations[i].outlier) << name << i;
  }
}

}  // namespace
}  // namespace holdfast
