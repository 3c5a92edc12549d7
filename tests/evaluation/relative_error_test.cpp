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
    estimate[i].T_world_camera.linear() = Eigen::AngleAxisd(M_PI / 180.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
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

TEST(ScaleDrift, IsTheScaleOfWindowsRelativeToTheWhole) {
  // The estimate shrinks steadily to 80 % along a curve, in a unit of its own.
  const Trajectory truth = test::wavy_trajectory(601, 20.0);
  Trajectory estimate = truth;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double scale = 3.0 * (1.0 - 0.2 * static_cast<double>(i) / static_cast<double>(truth.size()));
    estimate[i].T_world_camera.translation() =
        estimate[i - 1].T_world_camera.translation() +
        scale * (truth[i].T_world_camera.translation() - truth[i - 1].T_world_camera.translation());
  }
  EvaluationOptions options;
  options.alignment = AlignmentKind::sim3;
  const Evaluation evaluation = evaluate(truth, estimate, options);
  ASSERT_TRUE(evaluation.scale_drift.has_value());
  const ScaleDrift& drift = *evaluation.scale_drift;
  ASSERT_EQ(drift.windows.size(), 10u);
  std::size_t pairs = 0;
  for (std::size_t w = 0; w < 10; ++w) {
    pairs += drift.windows[w].pairs;
    if (w == 0) continue;
    EXPECT_GT(drift.windows[w].scale, drift.windows[w - 1].scale);
    EXPECT_NEAR(drift.windows[w].begin, drift.windows[w - 1].end + 0.05, 1e-9);
  }
  EXPECT_EQ(pairs, 601u);
  // The middles of the first and the last window are at 5 % and 95 % of the path, where the scale is 0.99 and 0.81.
  EXPECT_NEAR(drift.drift, 0.99 / 0.81 - 1.0, 0.02);
  EXPECT_NEAR(drift.spread, drift.drift, 1e-12);
  EXPECT_NE(to_text(evaluation).find("by windows of a tenth of the true path"), std::string::npos);
  EXPECT_NE(to_json(evaluation).find("\"spread_percent\""), std::string::npos);
  EXPECT_NE(to_csv(evaluation).find("scale_drift,first_to_last"), std::string::npos);
}

TEST(ScaleDrift, IsNothingWithoutADrift) {
  const Trajectory truth = test::wavy_trajectory(301, 20.0);
  EvaluationOptions options;
  EXPECT_FALSE(evaluate(truth, truth, options).scale_drift.has_value()) << "the scale is not estimated";
  options.alignment = AlignmentKind::sim3;
  const Evaluation same = evaluate(truth, test::moved(truth, test::some_transform(), 0.3), options);
  EXPECT_NEAR(same.scale_drift->spread, 0.0, 1e-9);
  EXPECT_NEAR(same.alignment.scale, 1.0 / 0.3, 1e-9);
  const Trajectory few = test::wavy_trajectory(50, 20.0);
  EXPECT_FALSE(evaluate(few, few, options).scale_drift.has_value()) << "five pairs in a window";
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
