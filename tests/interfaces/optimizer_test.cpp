// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/optimizer.hpp"

#include <gtest/gtest.h>

#include "geometry/synthetic.hpp"
#include "holdfast/core/check.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

TEST(Optimizer, AdjustsASinglePoseByDefault) {
  const Camera camera = synthetic::camera();
  synthetic::PoseCase by_default = synthetic::pose_case(camera, 200, 1.0, 0.2, 1);
  synthetic::PoseCase by_geometry = by_default;
  const PoseSummary summary = test::PoseOptimizer().optimize_pose(by_default.problem);
  ASSERT_TRUE(summary.usable);
  EXPECT_LT(synthetic::distance(by_default.problem.T_camera_world, by_default.truth), 0.01);
  EXPECT_EQ(geometry::adjust_pose(by_geometry.problem).inliers, summary.inliers);
  EXPECT_EQ(by_geometry.problem.T_camera_world.matrix(), by_default.problem.T_camera_world.matrix());
  EXPECT_EQ(by_geometry.problem.inlier, by_default.problem.inlier);
}

TEST(Optimizer, PoseProblemsAreChecked) {
  const Camera camera = synthetic::camera();
  PoseProblem problem = synthetic::pose_case(camera, 20, 1.0, 0.0, 1).problem;
  problem.camera = nullptr;
  EXPECT_THROW(test::PoseOptimizer().optimize_pose(problem), CheckError);
  EXPECT_THROW(geometry::find_pose(problem), CheckError);
  problem.camera = &camera;
  problem.right_x.pop_back();
  EXPECT_THROW(test::PoseOptimizer().optimize_pose(problem), CheckError);
  EXPECT_THROW(geometry::find_pose(problem), CheckError);
}

}  // namespace
}  // namespace holdfast
