// SPDX-License-Identifier: BSD-3-Clause
// Errors whose cause is not the estimate are named, and right trajectories are not suspected.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "evaluation/synthetic_trajectory.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/time_offset.hpp"

namespace holdfast {
namespace {

using test::moved;
using test::some_transform;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A camera in the hand: 30 s that fill all dimensions while it turns about all axes.
Trajectory handheld(double rate, double seconds = 30.0, double begin = 1305031102.175, double extent = 1.0) {
  Trajectory trajectory;
  for (int i = 0; i < static_cast<int>(seconds * rate); ++i) {
    const double t = i / rate;
    TimedPose pose;
    pose.timestamp = begin + t;
    pose.T_world_camera = Eigen::Translation3d(extent * Eigen::Vector3d(0.5 * std::sin(t), 0.3 * std::cos(1.7 * t),
                                                                        0.2 * std::sin(0.9 * t + 1.0))) *
                          Eigen::AngleAxisd(0.3 * std::sin(1.1 * t), Eigen::Vector3d::UnitX()) *
                          Eigen::AngleAxisd(0.4 * std::cos(0.7 * t), Eigen::Vector3d::UnitY()) *
                          Eigen::AngleAxisd(0.2 * std::sin(1.9 * t), Eigen::Vector3d::UnitZ());
    trajectory.push_back(pose);
  }
  return trajectory;
}

/// An estimate in a world of its own, with independent errors of 5 mm and 0.1 degrees in each direction.
Trajectory estimated(Trajectory truth, double noise = 0.005) {
  Random random(7);
  const auto vector = [&] { return Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
  for (TimedPose& pose : truth) {
    pose.T_world_camera.translation() += noise * vector();
    const Eigen::Vector3d turn = 0.35 * noise * vector();
    pose.T_world_camera.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  return moved(std::move(truth), some_transform());
}

template <class Change>
Trajectory changed(Trajectory trajectory, const Change& change) {
  for (TimedPose& pose : trajectory) change(pose);
  return trajectory;
}
Trajectory inverted(Trajectory trajectory) {
  return changed(std::move(trajectory),
                 [](TimedPose& pose) { pose.T_world_camera = Eigen::Isometry3d(pose.T_world_camera.inverse()); });
}
Trajectory delayed(Trajectory trajectory, double seconds) {
  return changed(std::move(trajectory), [&](TimedPose& pose) { pose.timestamp += seconds; });
}
Trajectory scaled(Trajectory trajectory, double factor) {
  return changed(std::move(trajectory), [&](TimedPose& pose) { pose.T_world_camera.translation() *= factor; });
}

std::vector<std::string> texts(const Evaluation& evaluation) {
  std::vector<std::string> texts;
  for (const Diagnostic& warning : evaluation.warnings) texts.push_back(warning.to_string());
  return texts;
}
std::vector<std::string> warnings(const Trajectory& truth, const Trajectory& estimate,
                                  const EvaluationOptions& options = {}) {
  return texts(evaluate(truth, estimate, options));
}

const Trajectory true_poses = handheld(100.0);
const Trajectory estimate_of_truth = estimated(handheld(30.0));

TEST(Suspicions, NoneOfRightTrajectories) {
  EXPECT_THAT(warnings(true_poses, estimate_of_truth), IsEmpty());
  EXPECT_THAT(warnings(true_poses, estimated(handheld(30.0), 0.05)), IsEmpty()) << "a bad estimate";
  EXPECT_THAT(warnings(handheld(20.0), estimated(handheld(20.0))), IsEmpty()) << "truth of a total station";
  EXPECT_THAT(warnings(true_poses, estimated(handheld(2.0))), IsEmpty()) << "keyframes";
  EXPECT_THAT(warnings(true_poses, estimated(handheld(30.0, 2.0))), IsEmpty()) << "two seconds";
  EXPECT_THAT(warnings(handheld(30.0, 0.5), estimated(handheld(30.0, 0.5))), IsEmpty()) << "half a second";
  EXPECT_THAT(warnings(true_poses, handheld(30.0)), IsEmpty()) << "a perfect estimate";
  EXPECT_THAT(warnings(true_poses, scaled(estimate_of_truth, 1.1)), IsEmpty()) << "a depth factor that is 10 % off";
  EXPECT_THAT(warnings(true_poses, delayed(estimate_of_truth, 0.01)), IsEmpty()) << "clocks synchronised to 10 ms";
  Trajectory with_gap = estimate_of_truth;
  with_gap.erase(with_gap.begin() + 300, with_gap.begin() + 600);
  EXPECT_THAT(warnings(true_poses, with_gap), IsEmpty());
  EvaluationOptions sim3;
  sim3.alignment = AlignmentKind::sim3;
  EXPECT_THAT(warnings(true_poses, scaled(estimate_of_truth, 0.07), sim3), IsEmpty()) << "one camera";
  EvaluationOptions without;
  without.alignment = AlignmentKind::none;
  EXPECT_THAT(warnings(true_poses, moved(estimate_of_truth, some_transform().inverse()), without), IsEmpty());
  // A vehicle on a straight road, a camera on a tripod, one that turns on the spot, and a lost one.
  const Trajectory road = test::straight_trajectory(400, 10.0, 12.0);
  EXPECT_THAT(warnings(road, estimated(road, 0.05)), IsEmpty());
  const Trajectory tripod = changed(handheld(30.0), [](TimedPose& pose) { pose.T_world_camera.setIdentity(); });
  EXPECT_THAT(warnings(tripod, estimated(tripod, 0.001)), IsEmpty());
  const Trajectory turning = scaled(handheld(30.0), 0.0);
  EXPECT_THAT(warnings(turning, estimated(turning, 0.002)), IsEmpty());
  EXPECT_THAT(warnings(true_poses, estimated(handheld(30.0), 0.6)), IsEmpty());
  // Turns about a point near the camera; the estimate has the rotations, but drifts: its inverse poses lie on a sphere,
  // as the true positions do.
  const Trajectory lever = changed(handheld(30.0), [](TimedPose& pose) {
    pose.T_world_camera.translation() = pose.T_world_camera.linear() * Eigen::Vector3d(0.0, 0.0, 0.3);
  });
  const Trajectory drifting = changed(lever, [](TimedPose& pose) {
    const double t = pose.timestamp - 1305031102.175;
    pose.T_world_camera.translation() = Eigen::Vector3d(0.002 * t, 0.001 * t, 0.3);
  });
  EXPECT_THAT(warnings(lever, drifting), IsEmpty());
}

TEST(Suspicions, TimeStampsThatAreNotSeconds) {
  const auto in_unit = [](const Trajectory& trajectory, double per_second) {
    return changed(trajectory, [&](TimedPose& pose) { pose.timestamp = per_second * (pose.timestamp - 1305031102.0); });
  };
  const Evaluation evaluation = evaluate(in_unit(handheld(30.0), 1e3), in_unit(estimate_of_truth, 1e3));
  EXPECT_THAT(texts(evaluation),
              ElementsAre(AllOf(HasSubstr("the time stamps of truth look like milliseconds"), HasSubstr("by 1000")),
                          HasSubstr("the time stamps of estimate look like milliseconds")));
  EXPECT_EQ(evaluation.error_per_time.pairs, 0U) << "no pose is compared with itself";
  EXPECT_THAT(to_text(evaluation), HasSubstr("No pair of poses is 1 s apart"));
  EXPECT_THAT(warnings(in_unit(handheld(30.0), 1e6), in_unit(estimate_of_truth, 1e6)),
              ElementsAre(HasSubstr("microseconds"), HasSubstr("divide them by 1e6")));
}

TEST(Suspicions, AClockThatIsLate) {
  const std::vector<std::string> late = warnings(delayed(true_poses, 0.1), estimate_of_truth);
  EXPECT_THAT(late, ElementsAre(AllOf(HasSubstr("seem to differ by 0.100 s (truth is late)"),
                                      HasSubstr("--time-offset 0.100"))));
  EXPECT_THAT(warnings(true_poses, delayed(estimate_of_truth, 0.4)),
              ElementsAre(HasSubstr("0.400 s (estimate is late)")));

  EXPECT_THAT(warnings(true_poses, delayed(estimate_of_truth, 3.0)), ElementsAre(HasSubstr("0 s (estimate is late)")));

  EvaluationOptions options;
  options.time_offset = estimate_time_offset(delayed(true_poses, 0.1), estimate_of_truth)->offset;
  EXPECT_NEAR(options.time_offset, 0.1, 0.002);
  const Evaluation mended = evaluate(delayed(true_poses, 0.1), estimate_of_truth, options);
  const Evaluation right = evaluate(true_poses, estimate_of_truth);
  EXPECT_THAT(texts(mended), IsEmpty());
  EXPECT_NEAR(mended.absolute_error.rmse, right.absolute_error.rmse, 2e-4);
  EXPECT_NEAR(mended.error_per_time.translation.rmse, right.error_per_time.translation.rmse, 2e-4);
  EXPECT_EQ(mended.poses.front().timestamp, estimate_of_truth.front().timestamp) << "stamps stay as given";
  EXPECT_EQ(mended.estimate_track.back().timestamp, estimate_of_truth.back().timestamp);
  EXPECT_THAT(to_text(mended), HasSubstr("s added to the stamps of the estimate"));
}

TEST(TimeOffset, IsFoundWhicheverTrajectoryIsDenser) {
  for (const double truth_rate : {4.0, 10.0, 25.0, 200.0})
    for (const double offset : {-0.73, -0.05, 0.0, 0.25}) {
      const auto found = estimate_time_offset(handheld(truth_rate), delayed(estimate_of_truth, -offset));
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->offset, offset, truth_rate < 9.0 ? 0.01 : 0.002) << truth_rate;
      EXPECT_FALSE(found->at_limit);
      EXPECT_LE(found->error, found->error_without);
    }
  EXPECT_TRUE(estimate_time_offset(true_poses, delayed(estimate_of_truth, 1.7), 0.5)->at_limit);
  EXPECT_NEAR(estimate_time_offset(true_poses, delayed(estimate_of_truth, 1.7), 3.0)->offset, -1.7, 0.002);
  EXPECT_FALSE(estimate_time_offset(true_poses, delayed(estimate_of_truth, 500.0)).has_value());
  EXPECT_FALSE(estimate_time_offset(scaled(true_poses, 0.0), estimate_of_truth).has_value());
  EXPECT_FALSE(estimate_time_offset({}, {}).has_value());
}

TEST(Suspicions, InvertedPoses) {
  EXPECT_THAT(warnings(inverted(true_poses), estimate_of_truth),
              ElementsAre(AllOf(HasSubstr("the poses of truth look inverted"), HasSubstr("--invert truth"))));
  const Trajectory in_another_world = moved(true_poses, some_transform().inverse());
  EXPECT_THAT(warnings(in_another_world, inverted(estimate_of_truth)),
              ElementsAre(AllOf(HasSubstr("the poses of estimate look inverted"), HasSubstr("--invert estimate"))));
}

TEST(Suspicions, ALeftHandedTruth) {
  const auto positions = changed(true_poses, [](TimedPose& pose) { pose.T_world_camera.translation().y() *= -1.0; });
  EXPECT_THAT(warnings(positions, estimate_of_truth),
              ElementsAre(AllOf(HasSubstr("mirror images"), HasSubstr("left-handed"),
                                HasSubstr("reverse the sign of one coordinate of the positions"))));
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    signs[axis] = -1.0;
    const auto poses = changed(true_poses, [&](TimedPose& pose) {
      pose.T_world_camera.linear() = (signs.asDiagonal() * pose.T_world_camera.linear() * signs.asDiagonal()).eval();
      pose.T_world_camera.translation() = signs.cwiseProduct(pose.T_world_camera.translation()).eval();
    });
    EXPECT_THAT(warnings(poses, estimate_of_truth),
                ElementsAre(AllOf(HasSubstr("mirror images"), HasSubstr(std::string("--mirror ") + "xyz"[axis]))));
  }
}

TEST(Suspicions, AnotherUnitOfLength) {
  EXPECT_THAT(warnings(scaled(true_poses, 1000.0), estimate_of_truth),
              ElementsAre(AllOf(HasSubstr("positions of truth look like millimetres"), HasSubstr("--truth-unit mm"))));
  EXPECT_THAT(warnings(true_poses, scaled(estimate_of_truth, 100.0)),
              ElementsAre(AllOf(HasSubstr("of estimate look like centimetres"), HasSubstr("--estimate-unit cm"))));
  EXPECT_THAT(warnings(true_poses, scaled(estimate_of_truth, 0.4)),
              ElementsAre(AllOf(HasSubstr("2.50 times as large"), HasSubstr("depth factor"), HasSubstr("sim3"))));
}

TEST(Suspicions, ATruthOfAnotherBody) {
  const Eigen::Isometry3d T_camera_marker =
      Eigen::Translation3d(0.02, -0.05, 0.01) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -1, 0.3).normalized());
  const auto markers =
      changed(true_poses, [&](TimedPose& pose) { pose.T_world_camera = pose.T_world_camera * T_camera_marker; });
  EXPECT_THAT(warnings(markers, estimate_of_truth),
              ElementsAre(AllOf(HasSubstr("orientations of truth are not those of the camera"), HasSubstr("114."))));
}

TEST(Suspicions, ATruthThatNeverMoves) {
  EXPECT_THAT(warnings(scaled(true_poses, 0.0), estimate_of_truth), ElementsAre(HasSubstr("the truth never moves")));
  EXPECT_THAT(warnings(true_poses, scaled(estimate_of_truth, 0.0)), ElementsAre(HasSubstr("the estimate never moves")));
}

TEST(Suspicions, ATruthAtOneHertz) {
  const Evaluation right = evaluate(true_poses, estimate_of_truth);
  const Evaluation slow = evaluate(handheld(1.0), estimate_of_truth);
  EXPECT_THAT(texts(slow), ElementsAre(AllOf(HasSubstr("only 30 of "), HasSubstr("a pose every 1.000 s"))));
  // The relative error is over the poses that have a truth, not over those that are up to two seconds from one.
  EXPECT_EQ(slow.error_per_time.pairs, 29U);
  EXPECT_NEAR(slow.error_per_time.translation.rmse, right.error_per_time.translation.rmse, 0.002);
  EXPECT_NEAR(slow.error_per_time.rotation.rmse, right.error_per_time.rotation.rmse, 0.1);
  Trajectory with_gap = true_poses;
  with_gap.erase(with_gap.begin() + 1000, with_gap.end() - 10);
  EXPECT_THAT(warnings(with_gap, estimate_of_truth),
              ElementsAre(AllOf(HasSubstr("only 30"), HasSubstr("gaps"), HasSubstr("--time-offset estimate"))));
}

TEST(Suspicions, AreInAllOutputsForPrograms) {
  const Evaluation evaluation = evaluate(scaled(true_poses, 1000.0), estimate_of_truth);
  EXPECT_EQ(nlohmann::json::parse(to_json(evaluation)).at("warnings").size(), 1U);
  EXPECT_THAT(to_csv(evaluation), HasSubstr("warnings,count,1,\n"));
  EXPECT_TRUE(nlohmann::json::parse(to_json(evaluate(true_poses, estimate_of_truth))).at("warnings").empty());
}

}  // namespace
}  // namespace holdfast
