// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/bundle_selection.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "geometry/synthetic.hpp"
#include "holdfast/core/check.hpp"

namespace holdfast {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();
const Camera camera = synthetic::camera();

/// A free pose (0) and a fixed one (1) before points two metres away; observations are added by the tests.
BundleProblem problem_with(std::vector<BundleProblem::Observation> observations) {
  BundleProblem problem;
  problem.camera = &camera;
  problem.poses = {{Eigen::Isometry3d::Identity(), false}, {Eigen::Isometry3d::Identity(), true}};
  problem.points = {{0.0, 0.0, 2.0}, {0.1, 0.0, 2.0}, {0.0, 0.0, -2.0}};
  problem.observations = std::move(observations);
  return problem;
}
BundleProblem::Observation seen(std::uint32_t pose, std::uint32_t point, float right_x = 300.0f) {
  return {.pose = pose, .point = point, .x = 318.0f, .y = 255.0f, .right_x = right_x};
}
std::vector<int> counting(const BundleProblem& problem) {
  BundleSelection selection;
  selection.select(problem);
  return {selection.observation_counts.begin(), selection.observation_counts.end()};
}

TEST(BundleSelection, APointNeedsAFreePoseAndThreeResiduals) {
  EXPECT_EQ(counting(problem_with({seen(0, 0)})), std::vector<int>{1});
  EXPECT_EQ(counting(problem_with({seen(1, 0)})), std::vector<int>{0}) << "no free pose";
  EXPECT_EQ(counting(problem_with({seen(0, 0, none)})), std::vector<int>{0}) << "two residuals";
  EXPECT_EQ(counting(problem_with({seen(0, 0, none), seen(1, 0, none), seen(1, 1)})), (std::vector<int>{1, 1, 0}));
}

TEST(BundleSelection, LeavesOutWhatIsBehindWeightlessOrNotFinite) {
  BundleProblem problem = problem_with({seen(0, 2), seen(0, 0), seen(0, 0), seen(0, 0), seen(0, 0)});
  problem.observations[1].weight = 0.0f;
  problem.observations[2].x = none;
  problem.observations[3].inverse_sigma2 = -1.0f;
  EXPECT_EQ(counting(problem), (std::vector<int>{0, 0, 0, 0, 1}));
}

TEST(BundleSelection, OnlyObservedFreePosesMove) {
  BundleSelection selection;
  BundleProblem problem = problem_with({seen(0, 0), seen(1, 0)});
  selection.select(problem);
  EXPECT_EQ(selection.pose_moves, (std::vector<std::uint8_t>{1, 0}));
  problem.observations.clear();
  selection.select(problem);
  EXPECT_EQ(selection.pose_moves, (std::vector<std::uint8_t>{0, 0}));
}

TEST(BundleSelection, IndicesOutOfRangeThrow) {
  BundleSelection selection;
  EXPECT_THROW(selection.select(problem_with({seen(2, 0)})), CheckError);
  EXPECT_THROW(selection.select(problem_with({seen(0, 3)})), CheckError);
  EXPECT_THROW(selection.select({}), CheckError) << "no camera";
}

TEST(ChiSquare, HasALimitForEachNumberOfResiduals) {
  const BundleProblem problem = problem_with({seen(0, 0, none)});
  BundleProblem::Observation observation = problem.observations[0];
  observation.x = static_cast<float>(camera.cx) + 3.0f, observation.y = static_cast<float>(camera.cy);
  observation.inverse_sigma2 = 0.5f;
  const Eigen::Isometry3d& pose = problem.poses[0].T_camera_world;
  EXPECT_NEAR(chi_square(camera, pose, problem.points[0], observation), 4.5, 1e-4);
  EXPECT_FALSE(is_outlier(camera, pose, problem.points[0], observation, {5.0, 4.0}));
  EXPECT_TRUE(is_outlier(camera, pose, problem.points[0], observation, {4.0, 5.0}));
  observation.right_x = static_cast<float>(camera.right_x(camera.cx, 2.0));
  EXPECT_FALSE(is_outlier(camera, pose, problem.points[0], observation, {4.0, 5.0}));
  EXPECT_TRUE(is_outlier(camera, pose, problem.points[2], observation, {4.0, 5.0})) << "behind the camera";
}

}  // namespace
}  // namespace holdfast
