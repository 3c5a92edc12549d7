// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/evaluation_plots.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "evaluation/synthetic_trajectory.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using test::moved;
using test::some_transform;
using test::wavy_trajectory;
using ::testing::AllOf;
using ::testing::HasSubstr;

EvaluationOptions with_alignment(AlignmentKind kind) {
  EvaluationOptions options;
  options.alignment = kind;
  return options;
}

std::string error_of(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options = {}) {
  try {
    evaluate(truth, estimate, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Evaluation, RecoversARigidTransform) {
  const Trajectory truth = wavy_trajectory(300, 30.0);
  const Evaluation evaluation = evaluate(truth, moved(truth, some_transform().inverse()));
  EXPECT_EQ(evaluation.poses.size(), 300u);
  EXPECT_NEAR(evaluation.absolute_error.maximum, 0.0, 1e-12);
  EXPECT_TRUE(evaluation.alignment.rotation.isApprox(some_transform().linear(), 1e-12));
  EXPECT_TRUE(evaluation.alignment.translation.isApprox(some_transform().translation(), 1e-12));
  EXPECT_EQ(evaluation.alignment.scale, 1.0);
  EXPECT_NEAR(evaluation.error_per_time.translation.maximum, 0.0, 1e-12);
  EXPECT_NEAR(evaluation.error_per_way.translation.maximum, 0.0, 1e-12);
}

TEST(Evaluation, RecoversAScaleOnlyWithSim3) {
  const Trajectory truth = wavy_trajectory(300, 30.0);
  const Trajectory estimate = moved(truth, some_transform(), 0.25);
  const Evaluation similar = evaluate(truth, estimate, with_alignment(AlignmentKind::sim3));
  EXPECT_NEAR(similar.alignment.scale, 4.0, 1e-12);
  EXPECT_NEAR(similar.absolute_error.maximum, 0.0, 1e-12);
  EXPECT_NEAR(similar.error_per_time.translation.maximum, 0.0, 1e-12) << "RPE takes the scale too";
  const Evaluation rigid = evaluate(truth, estimate);
  EXPECT_EQ(rigid.alignment.scale, 1.0);
  EXPECT_GT(rigid.absolute_error.rmse, 0.1);
}

TEST(Evaluation, NeverAlignsByAReflection) {
  const Trajectory truth = wavy_trajectory(300, 30.0);
  Trajectory mirrored = truth;
  for (TimedPose& pose : mirrored) pose.T_world_camera.translation().x() *= -1.0;
  const Evaluation evaluation = evaluate(truth, mirrored);
  EXPECT_NEAR(evaluation.alignment.rotation.determinant(), 1.0, 1e-12);
  EXPECT_GT(evaluation.absolute_error.rmse, 0.05);
}

TEST(Evaluation, WithoutAlignmentComparesAsTheyAre) {
  const Trajectory truth = wavy_trajectory(100, 30.0);
  const Eigen::Isometry3d shift(Eigen::Translation3d(0.0, 0.3, 0.4));
  const Evaluation evaluation = evaluate(truth, moved(truth, shift), with_alignment(AlignmentKind::none));
  EXPECT_NEAR(evaluation.absolute_error.minimum, 0.5, 1e-12);
  EXPECT_NEAR(evaluation.absolute_error.maximum, 0.5, 1e-12);
  EXPECT_NEAR(evaluation.absolute_error.standard_deviation, 0.0, 1e-12);
}

TEST(Evaluation, MeasuresKnownNoise) {
  const Trajectory truth = wavy_trajectory(4000, 30.0);
  Trajectory estimate = moved(truth, some_transform());
  Random random(3);
  constexpr double sigma = 0.01;
  for (TimedPose& pose : estimate)
    pose.T_world_camera.translation() += sigma * Eigen::Vector3d{random.normal(), random.normal(), random.normal()};
  const Evaluation evaluation = evaluate(truth, estimate);
  // The length of a normal vector in space: root mean square sigma sqrt(3), mean sigma sqrt(8 / pi).
  EXPECT_NEAR(evaluation.absolute_error.rmse, sigma * std::sqrt(3.0), 0.02 * sigma * std::sqrt(3.0));
  EXPECT_NEAR(evaluation.absolute_error.mean, sigma * 1.5958, 0.02 * sigma * 1.5958);
  EXPECT_NEAR(evaluation.error_per_time.translation.rmse, sigma * std::sqrt(6.0), 0.03 * sigma * std::sqrt(6.0));
}

TEST(Evaluation, AcceptsUnsortedDuplicateAndUnusablePoses) {
  const Trajectory truth = wavy_trajectory(60, 30.0);
  Trajectory estimate = truth;
  estimate[10].T_world_camera.translation().x() = std::numeric_limits<double>::quiet_NaN();
  TimedPose replaced = estimate[20];
  estimate[20].T_world_camera.translation().x() += 9.0;  // the later pose with this stamp is the right one
  std::swap(estimate[3], estimate[40]);
  estimate.push_back(replaced);
  const Evaluation evaluation = evaluate(truth, estimate);
  EXPECT_EQ(evaluation.estimate_poses, 59u);
  EXPECT_EQ(evaluation.poses.size(), 59u);
  EXPECT_NEAR(evaluation.absolute_error.maximum, 0.0, 1e-12);
}

TEST(Evaluation, KnowsCoverageOnlyWithFrames) {
  const Trajectory truth = wavy_trajectory(100, 30.0);
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 30, estimate.begin() + 50);
  EXPECT_FALSE(evaluate(truth, estimate).coverage.has_value());
  std::vector<double> frames;
  for (const TimedPose& pose : truth) frames.insert(frames.begin(), pose.timestamp);  // unsorted on purpose
  const Evaluation evaluation = evaluate(truth, estimate, {}, frames);
  ASSERT_TRUE(evaluation.coverage.has_value());
  EXPECT_DOUBLE_EQ(evaluation.coverage->ratio(), 0.8);
  EXPECT_EQ(evaluation.coverage->longest_gap(), 20u);
  EXPECT_THROW(evaluate(truth, estimate, {}, std::vector<double>{}), Error);
}

TEST(Evaluation, SaysWhyThereAreTooFewPairs) {
  const Trajectory truth = wavy_trajectory(100, 30.0, 100.0);
  const std::string apart = error_of(truth, wavy_trajectory(50, 30.0, 500.0));
  EXPECT_THAT(apart, HasSubstr("found 0 pairs"));
  EXPECT_THAT(apart, HasSubstr("truth holds 100 poses from 100.000000 to 103.300000 s"));
  EXPECT_THAT(apart, HasSubstr("estimate holds 50 poses from 500.000000"));
  EXPECT_THAT(apart, HasSubstr("do not overlap in time"));
  EXPECT_THAT(error_of(truth, {}), HasSubstr("estimate holds no pose"));
  EXPECT_THAT(error_of(wavy_trajectory(100, 10.0, 100.05), wavy_trajectory(100, 10.0, 100.0)),
              HasSubstr("allow a larger difference"));
}

TEST(Evaluation, RefusesOptionsOutOfRange) {
  const Trajectory truth = wavy_trajectory(10, 30.0);
  EvaluationOptions options;
  options.max_time_difference = 0.0;
  EXPECT_THAT(error_of(truth, truth, options), HasSubstr("expected a positive number"));
  options = {};
  options.path_step = -1.0;
  EXPECT_THAT(error_of(truth, truth, options), HasSubstr("path step"));
}

TEST(Evaluation, RefusesSim3OfAnEstimateThatNeverMoves) {
  const Trajectory truth = wavy_trajectory(50, 30.0);
  Trajectory still = truth;
  for (TimedPose& pose : still) pose.T_world_camera.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
  EXPECT_THAT(error_of(truth, still, with_alignment(AlignmentKind::sim3)), HasSubstr("never moves"));
  EXPECT_GT(evaluate(truth, still).absolute_error.rmse, 0.1);
}

TEST(EvaluationOutput, HoldsTheSameFiguresInJsonAndCsv) {
  const Trajectory truth = wavy_trajectory(100, 30.0);
  Trajectory estimate = truth;
  Random random(5);
  for (TimedPose& pose : estimate) pose.T_world_camera.translation().x() += 0.01 * random.normal();
  estimate.erase(estimate.begin() + 30);
  std::vector<double> frames;
  for (const TimedPose& pose : truth) frames.push_back(pose.timestamp);
  const Evaluation evaluation = evaluate(truth, estimate, {}, frames);

  const auto json = nlohmann::json::parse(to_json(evaluation));
  EXPECT_EQ(json["ate_m"]["rmse"].get<double>(), evaluation.absolute_error.rmse);
  EXPECT_EQ(json["alignment"]["kind"], "se3");
  EXPECT_EQ(json["pairing"]["pairs"], 99);
  EXPECT_EQ(json["coverage"]["ratio"].get<double>(), 0.99);
  EXPECT_EQ(json["rpe_per_time"]["rotation_deg"]["median"].get<double>(), evaluation.error_per_time.rotation.median);

  std::stringstream csv(to_csv(evaluation));
  std::string line;
  double rmse = 0.0, way_mean = 0.0;
  while (std::getline(csv, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 3) << line;
    if (line.rfind("ate,rmse,", 0) == 0) rmse = std::stod(line.substr(9));
    if (line.rfind("rpe_per_way_translation,mean,", 0) == 0) way_mean = std::stod(line.substr(29));
  }
  EXPECT_EQ(rmse, evaluation.absolute_error.rmse);
  EXPECT_EQ(way_mean, evaluation.error_per_way.translation.mean);
}

TEST(EvaluationOutput, TracksHoldAlignedPoses) {
  const Trajectory truth = wavy_trajectory(100, 30.0);
  const auto json = nlohmann::json::parse(
      to_tracks_json(evaluate(truth, moved(truth, some_transform(), 0.5), with_alignment(AlignmentKind::sim3))));
  for (const char* key : {"truth", "estimate", "truth_rotation", "estimate_rotation", "error"})
    ASSERT_EQ(json.at(key).size(), 100u) << key;
  for (std::size_t i = 0; i < 100; ++i) {
    const Eigen::Quaterniond expected(truth[i].T_world_camera.linear());
    for (const char* key : {"truth_rotation", "estimate_rotation"}) {
      const auto row = json.at(key).at(i).get<std::vector<double>>();
      ASSERT_EQ(row.size(), 4u);
      const Eigen::Quaterniond found(row[3], row[0], row[1], row[2]);
      EXPECT_NEAR(found.angularDistance(expected), 0.0, 1e-4) << key << " row " << i;
    }
  }
}

TEST(EvaluationOutput, SaysWhatIsUnknown) {
  const Trajectory truth = test::straight_trajectory(50, 30.0, 0.1);  // 0.16 m: no pair is 1 m apart
  EvaluationOptions options;
  options.truth_name = "odd \xff name";
  const Evaluation evaluation = evaluate(truth, truth, options);
  const auto json = nlohmann::json::parse(to_json(evaluation));
  EXPECT_TRUE(json["coverage"].is_null());
  EXPECT_TRUE(json["rpe_per_way"]["translation_m"]["rmse"].is_null());
  EXPECT_THAT(to_csv(evaluation), HasSubstr("coverage,ratio,unknown,\n"));
  EXPECT_THAT(to_text(evaluation), HasSubstr("coverage   unknown"));
  EXPECT_THAT(to_text(evaluation), HasSubstr("No pair of poses is 1 m of true path apart."));
}

TEST(EvaluationOutput, StatesAlignmentPairingAndPairs) {
  const Trajectory truth = wavy_trajectory(100, 30.0);
  const std::string text =
      to_text(evaluate(truth, moved(truth, some_transform(), 0.5), with_alignment(AlignmentKind::sim3)));
  EXPECT_THAT(text, HasSubstr("alignment  sim3"));
  EXPECT_THAT(text, HasSubstr("scale 2.000000"));
  EXPECT_THAT(text, HasSubstr("one-to-one, nearest stamps first, closer than 0.02 s: 100 pairs"));
}

/// A camera on an ellipse with the given half axes [m]; `up` is the direction in the world that is up in its images.
Trajectory carried(const Eigen::Vector3d& extent, const Eigen::Vector3d& up) {
  Trajectory trajectory;
  for (int i = 0; i < 200; ++i) {
    const double t = i / 30.0;
    TimedPose pose;
    pose.timestamp = 100.0 + t;
    pose.T_world_camera.translation() =
        extent.cwiseProduct(Eigen::Vector3d(std::sin(t), std::cos(1.7 * t), std::sin(0.9 * t + 1.0)));
    const Eigen::AngleAxisd nod(0.3 * std::sin(t), Eigen::Vector3d::UnitX());
    pose.T_world_camera.linear() =
        (Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitY(), up) * nod).toRotationMatrix();
    trajectory.push_back(pose);
  }
  return trajectory;
}

TEST(EvaluationPlots, LookAlongGravity) {
  const auto view = [](const Eigen::Vector3d& extent, const Eigen::Vector3d& up) {
    const Trajectory truth = carried(extent, up);
    return top_view_svg(evaluate(truth, truth));
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  // The camera moves up and down more than to the sides: still from above.
  EXPECT_THAT(view({1, 0.5, 2}, z), HasSubstr("Top view (x-y)"));
  EXPECT_THAT(view({1, 0.5, 0.1}, z), HasSubstr("Top view (x-y)"));
  const std::string upright = view({1, 2, 0.5}, -y);
  EXPECT_THAT(upright, AllOf(HasSubstr("Top view (x-z)"), HasSubstr(">z [m]<")));
  // In a vertical plane the path would be a line from above.
  EXPECT_THAT(view({1, 0.05, 1}, z), HasSubstr("View along y (x-z)"));
  // A camera that is carried aslant does not tell where up is: the plane of the motion decides.
  EXPECT_THAT(view({0.1, 0.5, 1}, Eigen::Vector3d(1, 1, 1).normalized()), HasSubstr("View along x (y-z)"));
  EXPECT_THAT(view({1, 0.5, 0.1}, Eigen::Vector3d(1, 1, 1).normalized()), HasSubstr("Top view (x-y)"));
  EXPECT_THAT(view({1, 0.5, 0.6}, x), HasSubstr("Top view (y-z)"));
}

TEST(Evaluation, NamesStampsThatAreNoSeconds) {
  const Trajectory truth = wavy_trajectory(100, 30.0, 1.3e9);
  for (const auto& [factor, unit] : {std::pair{1e3, "milliseconds: divide them by 1000."},
                                     {1e6, "microseconds: divide them by 1e6."},
                                     {1e9, "nanoseconds: divide them by 1e9."}}) {
    Trajectory estimate = truth;
    for (TimedPose& pose : estimate) pose.timestamp *= factor;
    try {
      evaluate(truth, estimate);
      ADD_FAILURE() << unit;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("The stamps of estimate look like ") + unit));
      EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("overlap")));
    }
  }
}

TEST(EvaluationPlots, ColourThePathByItsError) {
  const Trajectory truth = wavy_trajectory(200, 30.0);
  Trajectory estimate = truth;
  for (std::size_t i = 100; i < 110; ++i) estimate[i].T_world_camera.translation().x() += 0.3;
  EvaluationOptions options;
  options.alignment = AlignmentKind::none;
  const std::string svg = top_view_svg(evaluate(truth, estimate, options));
  EXPECT_THAT(svg, AllOf(HasSubstr("stroke=\"#009e73\""), HasSubstr("stroke=\"#c8320a\""), HasSubstr(">above<")));
  // The truth is drawn last, so that the estimate does not hide it.
  EXPECT_GT(svg.rfind("stroke=\"#222222\""), svg.rfind("stroke=\"#c8320a\""));
  EXPECT_THAT(top_view_svg(evaluate(truth, truth, options)), ::testing::Not(HasSubstr("stroke=\"#c8320a\"")))
      << "no error is large";
}

TEST(EvaluationPlots, PositionsOverTime) {
  const Trajectory truth = wavy_trajectory(200, 30.0);
  const Evaluation evaluation = evaluate(truth, truth);
  EXPECT_THAT(position_over_time_svg(evaluation, 1), AllOf(HasSubstr(">y [m]<"), HasSubstr(">truth<")));
  EXPECT_THROW(position_over_time_svg(evaluation, 3), CheckError);
}

TEST(EvaluationPlots, AnglesOverTime) {
  const Trajectory truth = wavy_trajectory(200, 30.0);
  const Evaluation evaluation = evaluate(truth, truth);
  EXPECT_THAT(angle_over_time_svg(evaluation, 0), AllOf(HasSubstr(">roll over time<"), HasSubstr(">roll [deg]<")));
  EXPECT_THAT(angle_over_time_svg(evaluation, 2), AllOf(HasSubstr(">yaw [deg]<"), HasSubstr(">truth<")));
  EXPECT_THROW(angle_over_time_svg(evaluation, 3), CheckError);
}

TEST(EvaluationPlots, ShadeGaps) {
  const Trajectory truth = wavy_trajectory(200, 30.0);
  EXPECT_THAT(error_over_time_svg(evaluate(truth, truth)), ::testing::Not(HasSubstr("no pair of poses")));
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 60, estimate.begin() + 120);
  EXPECT_THAT(error_over_time_svg(evaluate(truth, estimate)), HasSubstr("no pair of poses"));
  std::vector<double> frames;
  for (const TimedPose& pose : truth) frames.push_back(pose.timestamp);
  EXPECT_THAT(error_over_time_svg(evaluate(truth, estimate, {}, frames)), HasSubstr("frames without a pose"));
}

}  // namespace
}  // namespace holdfast
