// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <string>

#include "both_optimizers.hpp"
#include "geometry/synthetic.hpp"

namespace holdfast {

/// Solves the problem with `schur`, and with the reference `ceres`, until nothing changes; compares costs, poses and
/// the number of outliers. `problem` and `reference` are the solutions. `pose_tolerance`: of synthetic::distance().
inline void expect_same_solution(BundleProblem& problem, BundleProblem& reference, const std::string& what,
                                 std::int64_t dense_poses, double pose_tolerance) {
  const std::atomic<bool> go_on = false;
  problem.robust_iterations = problem.final_iterations = 200;
  problem.function_tolerance = 1e-14;
  reference = problem;
  const BundleSummary expected = make_optimizer("ceres")->optimize_bundle(reference, go_on);
  const BundleSummary found = make_optimizer("schur", {{"dense_poses", dense_poses}})->optimize_bundle(problem, go_on);
  ASSERT_TRUE(expected.usable && found.usable) << what;
  EXPECT_NEAR(found.initial_cost, expected.initial_cost, 1e-9 * expected.initial_cost) << what;
  EXPECT_NEAR(found.final_cost, expected.final_cost, 1e-6 * expected.final_cost) << what;
  EXPECT_EQ(found.outliers, expected.outliers) << what;
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    EXPECT_LT(synthetic::distance(problem.poses[i].T_camera_world, reference.poses[i].T_camera_world), pose_tolerance)
        << what << ", pose " << i;
}

}  // namespace holdfast
