// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "evaluation/synthetic_trajectory.hpp"
#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {
namespace {

using test::straight_trajectory;

/// Truth: 1 m/s along x. Estimate: the same way, 10 % too long.
struct TooLong {
  Trajectory truth = straight_trajectory(201, 20.0, 1.0);
  Trajectory estimate = straight_trajectory(201, 20.0, 1.1);
};

TEST(RelativeError, PerTimeOfAConstantDrift) {
  const TooLong world;
  const RelativeError error = evaluate(world.truth, world.estimate).error_per_time;
  EXPECT_NEAR(error.translation.minimum, 0.1, 1e-9);
  EXPECT_NEAR(error.translation.maximum, 0.1, 1e-9);
  EXPECT_NEAR(error.rotation.maximum, 0.0, 1e-5);
  EXPECT_EQ(error.pairs, 180u) << "201 poses, 20 of which have none a second later, less the pair ending at the last";
  EXPECT_EQ(error.uneven_pairs, 0u);
}

TEST(RelativeError, PerWayOfAConstantDrift) {
  const TooLong world;
  EvaluationOptions options;
  options.path_step = 2.0;
  const RelativeError error = evaluate(world.truth, world.estimate, options).error_per_way;
  // The sum of steps may miss 2 m by a rounding error, and the next pose is 0.05 m further.
  EXPECT_GE(error.translation.minimum, 0.2 - 1e-9);
  EXPECT_LE(error.translation.maximum, 0.205 + 1e-9);
  EXPECT_GE(error.pairs, 160u);
  EXPECT_LE(error.pairs, 161u);
}

TEST(SegmentError, IsAShareOfTheLengthAsInKittisTool) {
  // 320 m along x, a pose each metre; the estimate is 2 % too long.
  const Trajectory truth = straight_trajectory(321, 10.0, 10.0), estimate = straight_trajectory(321, 10.0, 10.2);
  const SegmentError error = evaluate(truth, estimate).segment_error;
  ASSERT_EQ(error.lengths.size(), 3u);
  EXPECT_EQ(error.lengths[0].length, 100.0);
  // The segments begin at 0, 10, ... m and end at the first pose after 100 m.
  EXPECT_EQ(error.lengths[0].segments, 22u);
  EXPECT_EQ(error.lengths[2].segments, 2u);
  EXPECT_EQ(error.segments, 22u + 12u + 2u);
  EXPECT_NEAR(error.lengths[0].translation, 2.0, 0.021);
  EXPECT_NEAR(error.lengths[2].translation, 2.0, 0.007);
  EXPECT_NEAR(error.rotation, 0.0, 1e-6);
}

TEST(SegmentError, RotationIsPerMetre) {
  // The estimate turns by a degree between the poses at 50 and 51 m.
  const Trajectory truth = straight_trajectory(121, 10.0, 10.0);
  Trajectory estimate = truth;
  for (std::size_t i = 51; i < estimate.size(); ++i)
    estimate[i].T_world_camera.linear() =
        Eigen::AngleAxisd(M_PI / 180.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const SegmentError error = evaluate(truth, estimate).segment_error;
  ASSERT_EQ(error.lengths.size(), 1u);
  EXPECT_EQ(error.segments, 2u);
  EXPECT_NEAR(error.rotation, 0.01, 1e-6);
}

TEST(SegmentError, AShortPathHasNone) {
  const TooLong world;
  const Evaluation evaluation = evaluate(world.truth, world.estimate);
  EXPECT_EQ(evaluation.segment_error.segments, 0u);
  EXPECT_EQ(to_text(evaluation).find("KITTI"), std::string::npos);
}

TEST(RelativeError, TakesTheOrderOfTheBenchmarksTool) {
  // Between i and j the truth goes 1 m along x; the estimate does the same and turns by 90 degrees about z.
  Trajectory truth = straight_trajectory(3, 1.0, 1.0);
  Trajectory estimate = truth;
  estimate[1].T_world_camera.linear() = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const RelativeError error = evaluate(truth, estimate).error_per_time;
  // E inv(G) = (R, e_x) (I, -e_x) = (R, e_x - R e_x), as long as sqrt(2); inv(G) E would be (R, 0).
  ASSERT_EQ(error.pairs, 1u);
  EXPECT_NEAR(error.translation.mean, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(error.rotation.mean, 90.0, 1e-12);
}

TEST(RelativeError, GapsAreCountedPerTimeAndLeftOutPerWay) {
  TooLong world;
  world.estimate.erase(world.estimate.begin() + 60, world.estimate.begin() + 140);  // 4 s
  const Evaluation evaluation = evaluate(world.truth, world.estimate);
  EXPECT_GT(evaluation.error_per_time.uneven_pairs, 0u);
  EXPECT_GT(evaluation.error_per_way.omitted_pairs, 0u);
  EXPECT_LE(evaluation.error_per_way.translation.maximum, 0.11 + 1e-9);
  EXPECT_EQ(evaluation.error_per_way.pairs + evaluation.error_per_way.omitted_pairs, 201u - 80u - 20u);
}

TEST(RelativeError, PosesFarFromAnyTruthTakeNoPart) {
  TooLong world;
  world.truth.erase(world.truth.begin() + 60, world.truth.begin() + 140);
  const Evaluation evaluation = evaluate(world.truth, world.estimate);
  EXPECT_LT(evaluation.error_per_time.pairs, 110u);
  EXPECT_NEAR(evaluation.error_per_time.translation.median, 0.1, 1e-9);
}

}  // namespace
}  // namespace holdfast
