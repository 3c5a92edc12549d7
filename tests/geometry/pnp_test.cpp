// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/pnp.hpp"

#include <gtest/gtest.h>

#include "geometry/synthetic.hpp"

namespace holdfast::geometry {
namespace {

const Camera camera = synthetic::camera();

TEST(P3p, OneOfTheSolutionsIsTheTruth) {
  Random random(1);
  int found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Isometry3d truth = exp_se3(synthetic::tangent(random, 1.0, 1.0));
    std::array<Eigen::Vector3d, 3> points, directions;
    for (int i = 0; i < 3; ++i) {
      const double x = random.uniform(0, 640), y = random.uniform(0, 480);
      directions[i] = camera.back_project(x, y, 1.0);
      points[i] = truth.inverse() * (random.uniform(0.5, 5.0) * directions[i]);
    }
    double nearest = 1e9;
    for (const Eigen::Isometry3d& pose : solve_p3p(points, directions)) {
      nearest = std::min(nearest, synthetic::distance(pose, truth));
      for (int i = 0; i < 3; ++i)  // whatever the pose, the points are seen along the directions
        EXPECT_LT((pose * points[i]).normalized().cross(directions[i].normalized()).norm(), 1e-3);
    }
    found += nearest < 1e-5;
  }
  EXPECT_GE(found, 197);  // near-degenerate triples lose digits
}

TEST(FindPose, NeedsNoFirstGuess) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    synthetic::PoseCase c = synthetic::pose_case(camera, 100, 1.0, 0.5, seed);
    c.problem.T_camera_world = exp_se3(Vector6d::Constant(2.0));
    synthetic::PoseCase again = c;
    const PoseSummary summary = find_pose(c.problem);
    ASSERT_TRUE(summary.usable) << seed;
    EXPECT_GT(summary.inliers, 35);
    EXPECT_LT(synthetic::distance(c.problem.T_camera_world, c.truth), 0.02);
    find_pose(again.problem);
    EXPECT_EQ(c.problem.T_camera_world.matrix(), again.problem.T_camera_world.matrix());
  }
}

TEST(FindPose, RefusesWhenTooFewAgree) {
  synthetic::PoseCase c = synthetic::pose_case(camera, 60, 1.0, 0.0, 1);
  Random random(2);
  for (float& x : c.problem.x) x = static_cast<float>(random.uniform(0, 640));
  for (float& y : c.problem.y) y = static_cast<float>(random.uniform(0, 480));
  const Eigen::Isometry3d before = c.problem.T_camera_world;
  EXPECT_FALSE(find_pose(c.problem).usable);
  EXPECT_EQ(c.problem.T_camera_world.matrix(), before.matrix());
}

}  // namespace
}  // namespace holdfast::geometry
