// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "both_optimizers.hpp"
#include "geometry/synthetic.hpp"

namespace holdfast {
namespace {

/// What every optimizer must do; the parameter is its name.
class Bundle : public testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<Optimizer> make() { return make_optimizer(GetParam()); }
  /// Stops at a relative decrease of the cost alone.
  static std::unique_ptr<Optimizer> make(double function_tolerance, ParameterValues values = {}) {
    values["function_tolerance"] = function_tolerance;
    if (GetParam() == "schur") values["step_tolerance"] = 0.0;
    return make_optimizer(GetParam(), values);
  }
};
INSTANTIATE_TEST_SUITE_P(Optimizers, Bundle, testing::Values("ceres", "schur"),
                         [](const auto& each) { return each.param; });

const std::atomic<bool> go_on = false;
const Camera camera = synthetic::camera();

double largest_pose_error(const synthetic::BundleCase& c) {
  double largest = 0.0;
  for (std::size_t i = 0; i < c.poses.size(); ++i)
    largest = std::max(largest, synthetic::distance(c.problem.poses[i].T_camera_world, c.poses[i]));
  return largest;
}

TEST_P(Bundle, RecoversAPerturbedMapAndFlagsOutliers) {
  synthetic::BundleCase c = synthetic::bundle_case(camera, 3, 4, 300, 7, 0.5, 0.05, 1);
  const BundleProblem before = c.problem;
  const double error_before = largest_pose_error(c);
  const BundleSummary summary = make()->optimize_bundle(c.problem, go_on);
  ASSERT_TRUE(summary.usable);
  EXPECT_FALSE(summary.stopped);
  EXPECT_LT(summary.final_cost, summary.initial_cost);
  EXPECT_GT(error_before, 0.02);
  EXPECT_LT(largest_pose_error(c), 0.003);
  for (std::size_t i = 0; i < c.problem.poses.size(); ++i) {
    if (!before.poses[i].fixed) continue;
    EXPECT_EQ(c.problem.poses[i].T_camera_world.matrix(), before.poses[i].T_camera_world.matrix()) << "pose " << i;
  }
  // 5 % of the good ones lie beyond the 95 % limit; of the bad ones none may pass.
  int false_alarms = 0, flagged = 0;
  for (std::size_t i = 0; i < c.is_outlier.size(); ++i) {
    flagged += c.problem.observations[i].outlier;
    EXPECT_TRUE(c.problem.observations[i].outlier || !c.is_outlier[i]) << "observation " << i;
    false_alarms += c.problem.observations[i].outlier && !c.is_outlier[i];
  }
  EXPECT_LT(false_alarms, 0.10 * static_cast<double>(c.is_outlier.size()));
  EXPECT_EQ(flagged, summary.outliers);
  // Down to the noise: the squared residuals add up to the degrees of freedom, less what the limit cuts off.
  double residuals = 0.0;
  for (const BundleProblem::Observation& observation : c.problem.observations)
    if (!observation.outlier) residuals += std::isnan(observation.right_x) ? 2.0 : 3.0;
  const double freedom = residuals - 3.0 * static_cast<double>(c.points.size()) - 6.0 * 4;
  EXPECT_GT(2.0 * summary.final_cost / freedom, 0.75);
  EXPECT_LT(2.0 * summary.final_cost / freedom, 1.05);
}

TEST_P(Bundle, DenseAndSparseAgree) {
  synthetic::BundleCase dense = synthetic::bundle_case(camera, 2, 4, 200, 6, 0.5, 0.0, 2);
  synthetic::BundleCase sparse = dense;
  dense.problem.final_iterations = sparse.problem.final_iterations = 30;
  make(1e-12)->optimize_bundle(dense.problem, go_on);
  make(1e-12, {{"dense_poses", std::int64_t{0}}})->optimize_bundle(sparse.problem, go_on);
  for (std::size_t i = 0; i < dense.poses.size(); ++i)
    EXPECT_LT(synthetic::distance(dense.problem.poses[i].T_camera_world, sparse.problem.poses[i].T_camera_world), 1e-6);
}

TEST_P(Bundle, TwoRunsGiveTheSameBytes) {
  synthetic::BundleCase a = synthetic::bundle_case(camera, 3, 4, 200, 7, 0.5, 0.05, 3);
  synthetic::BundleCase b = a;
  const std::vector<double> elsewhere(12345);  // so that the second run finds other addresses
  make()->optimize_bundle(a.problem, go_on);
  make()->optimize_bundle(b.problem, go_on);
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    EXPECT_EQ(a.problem.poses[i].T_camera_world.matrix(), b.problem.poses[i].T_camera_world.matrix());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_EQ(a.problem.points[i], b.problem.points[i]);
}

TEST_P(Bundle, StopBeforeTheStartChangesNothing) {
  synthetic::BundleCase c = synthetic::bundle_case(camera, 2, 3, 60, 5, 0.5, 0.0, 4);
  const BundleProblem before = c.problem;
  const std::atomic<bool> stop = true;
  const BundleSummary summary = make()->optimize_bundle(c.problem, stop);
  EXPECT_TRUE(summary.stopped);
  EXPECT_FALSE(summary.usable);
  EXPECT_EQ(summary.iterations, 0);
  for (std::size_t i = 0; i < before.points.size(); ++i) EXPECT_EQ(c.problem.points[i], before.points[i]);
}

TEST_P(Bundle, StopBetweenIterationsKeepsTheBestSoFar) {
  // Large enough that a busy machine, whose threads wait for each other by some milliseconds, sets the flag in time.
  const synthetic::BundleCase c = synthetic::bundle_case(camera, 6, 30, 3000, 9, 0.5, 0.05, 8);
  BundleProblem full = c.problem;
  const auto optimizer = make(0.0);
  const BundleSummary unstopped = optimizer->optimize_bundle(full, go_on);
  ASSERT_GT(unstopped.iterations, 3);
  // Looks for a moment that falls into the iterations, wherever they are on this machine.
  double shortest = 0.0, longest = 2.0 * unstopped.seconds;
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double delay = 0.5 * (shortest + longest);
    BundleProblem problem = c.problem;
    std::atomic<bool> stop = false, runs = false;
    std::thread other([&] {
      runs = true;
      std::this_thread::sleep_for(std::chrono::duration<double>(delay));
      stop = true;
    });
    while (!runs) std::this_thread::yield();
    const BundleSummary summary = optimizer->optimize_bundle(problem, stop);
    other.join();
    if (summary.stopped && summary.usable && summary.iterations > 0 && summary.iterations < unstopped.iterations) {
      EXPECT_LT(summary.final_cost, summary.initial_cost);
      return;
    }
    if (summary.stopped)
      shortest = delay;
    else
      longest = delay;
    if (longest - shortest < 1e-3) shortest = 0.0, longest = 2.0 * unstopped.seconds;
  }
  FAIL() << "the stop flag was never seen between iterations";
}

TEST_P(Bundle, WeightZeroHasNoSay) {
  synthetic::BundleCase with = synthetic::bundle_case(camera, 2, 3, 80, 5, 0.5, 0.0, 5);
  synthetic::BundleCase without = with;
  // Two observations of the same pixel: one wrong and without weight, against one that is not there.
  BundleProblem::Observation wrong = with.problem.observations.front();
  wrong.x += 40.0f;
  wrong.weight = 0.0f;
  with.problem.observations.push_back(wrong);
  make()->optimize_bundle(with.problem, go_on);
  make()->optimize_bundle(without.problem, go_on);
  for (std::size_t i = 0; i < with.poses.size(); ++i)
    EXPECT_EQ(with.problem.poses[i].T_camera_world.matrix(), without.problem.poses[i].T_camera_world.matrix());
  EXPECT_TRUE(with.problem.observations.back().outlier);
}

TEST_P(Bundle, LeavesAloneWhatIsNotDetermined) {
  synthetic::BundleCase c = synthetic::bundle_case(camera, 2, 3, 80, 5, 0.5, 0.0, 6);
  const auto add_point = [&](std::uint32_t pose, float right_x) {
    BundleProblem::Observation observation = c.problem.observations.front();
    observation.pose = pose;
    observation.point = static_cast<std::uint32_t>(c.problem.points.size());
    observation.right_x = right_x;
    c.problem.points.push_back(c.poses[pose].inverse() * Eigen::Vector3d(0.1, 0.1, 2.0));
    c.problem.observations.push_back(observation);
    return c.problem.points.size() - 1;
  };
  std::uint32_t fixed = 0, free = 0;
  for (std::uint32_t i = 0; i < c.problem.poses.size(); ++i) (c.problem.poses[i].fixed ? fixed : free) = i;
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::size_t seen_by_fixed = add_point(fixed, 100.0f);
  const std::size_t seen_once = add_point(free, none);
  const std::vector<Eigen::Vector3d> before = c.problem.points;
  ASSERT_TRUE(make()->optimize_bundle(c.problem, go_on).usable);
  EXPECT_EQ(c.problem.points[seen_by_fixed], before[seen_by_fixed]);
  EXPECT_EQ(c.problem.points[seen_once], before[seen_once]);
}

TEST_P(Bundle, BadInputIsRefusedOrFlagged) {
  BundleProblem empty;
  empty.camera = &camera;
  EXPECT_FALSE(make()->optimize_bundle(empty, go_on).usable);

  synthetic::BundleCase c = synthetic::bundle_case(camera, 2, 3, 80, 5, 0.5, 0.0, 7);
  c.problem.observations[3].x = std::numeric_limits<float>::quiet_NaN();
  c.problem.points[c.problem.observations[40].point].z() = -5.0;  // behind every camera
  ASSERT_TRUE(make()->optimize_bundle(c.problem, go_on).usable);
  EXPECT_TRUE(c.problem.observations[3].outlier);
  EXPECT_TRUE(c.problem.observations[40].outlier);
  EXPECT_LT(largest_pose_error(c), 0.01);

  c.problem.observations[0].point = 100000;
  EXPECT_THROW(make()->optimize_bundle(c.problem, go_on), CheckError);
}

}  // namespace
}  // namespace holdfast
