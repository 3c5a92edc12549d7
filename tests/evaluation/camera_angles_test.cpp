// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/camera_angles.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "evaluation/synthetic_trajectory.hpp"
#include "holdfast/evaluation/evaluation_plots.hpp"

namespace holdfast {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A camera in a world whose z is up: yaw to the right of the x axis, pitch up, roll clockwise [deg].
Eigen::Matrix3d camera_with(double roll, double pitch, double yaw) {
  const Eigen::Vector3d forward(std::cos(pitch * degree) * std::cos(yaw * degree),
                                -std::cos(pitch * degree) * std::sin(yaw * degree), std::sin(pitch * degree));
  // Without roll the right edge of the image is level.
  const Eigen::Vector3d right(-std::sin(yaw * degree), -std::cos(yaw * degree), 0.0);
  Eigen::Matrix3d R;
  R << right, forward.cross(right), forward;
  return R * Eigen::AngleAxisd(roll * degree, Eigen::Vector3d::UnitZ());
}

/// Two seconds of a camera that moves while its angles change as the functions say, by the share of the time passed.
template <class Angles>
Trajectory turning(const Angles& angles, int count = 61) {
  Trajectory trajectory = test::wavy_trajectory(count, 30.0);
  for (int i = 0; i < count; ++i) {
    const auto [roll, pitch, yaw] = angles(static_cast<double>(i) / (count - 1));
    trajectory[static_cast<std::size_t>(i)].T_world_camera.linear() = camera_with(roll, pitch, yaw);
  }
  return trajectory;
}

struct Expected {
  double roll, pitch, yaw;
};

void expect_angles(const CameraAngles& found, const Expected& expected, double tolerance = 1e-6) {
  EXPECT_NEAR(found.roll, expected.roll, tolerance) << found.timestamp;
  EXPECT_NEAR(found.pitch, expected.pitch, tolerance) << found.timestamp;
  EXPECT_NEAR(found.yaw, expected.yaw, tolerance) << found.timestamp;
}

TEST(CameraAngles, AreThoseOfAKnownRotationInAnyFrameOfTheEstimate) {
  const auto angles = [](double s) { return Expected{20.0 * s, -30.0 + 40.0 * s, 500.0 * s}; };
  const Trajectory truth = turning(angles);
  const EvaluatedAngles found = camera_angles(evaluate(truth, test::moved(truth, test::some_transform())));
  ASSERT_EQ(found.truth.size(), truth.size());
  ASSERT_EQ(found.estimate.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Expected expected = angles(static_cast<double>(i) / 60.0);
    EXPECT_EQ(found.truth[i].timestamp, truth[i].timestamp);
    expect_angles(found.truth[i], expected);
    expect_angles(found.estimate[i], expected);
  }
}

TEST(CameraAngles, OfTheEstimateDifferByItsErrorAlsoAfterAGap) {
  const Trajectory truth = turning([](double s) { return Expected{0.0, 0.0, 900.0 * s}; });
  Trajectory estimate = truth;
  for (TimedPose& pose : estimate)  // the camera's own down axis is vertical here
    pose.T_world_camera.linear() *= Eigen::AngleAxisd(3.0 * degree, Eigen::Vector3d::UnitY()).toRotationMatrix();
  estimate.erase(estimate.begin() + 10, estimate.begin() + 50);
  const EvaluatedAngles found = camera_angles(evaluate(truth, estimate));
  ASSERT_EQ(found.estimate.size(), 21u);
  EXPECT_NEAR(found.estimate.front().yaw, 3.0, 1e-6);
  EXPECT_NEAR(found.estimate[10].yaw, 900.0 * 50.0 / 60.0 + 3.0, 1e-6);
  EXPECT_NEAR(found.estimate.back().yaw, 903.0, 1e-6);
}

TEST(CameraAngles, ContinueBeyondTheVertical) {
  // A short look over the zenith leaves the camera upright on average.
  const auto angles = [](double s) { return Expected{0.0, 130.0 * std::pow(std::sin(std::numbers::pi * s), 4), 0.0}; };
  const Trajectory truth = turning(angles);
  const EvaluatedAngles found = camera_angles(evaluate(truth, truth));
  for (std::size_t i = 0; i < truth.size(); ++i)
    expect_angles(found.truth[i], angles(static_cast<double>(i) / 60.0), 1e-4);
}

/// A car's world is often that of its first camera, in which y is down.
TEST(CameraAngles, TakeTheVerticalFromTheCamera) {
  const auto angles = [](double s) { return Expected{0.0, 0.0, 200.0 * s}; };
  const Trajectory upright = turning(angles);
  const Eigen::Isometry3d T_first_world(Eigen::Isometry3d(camera_with(0, 0, 0)).inverse());
  const Trajectory truth = test::moved(upright, T_first_world);
  const EvaluatedAngles found = camera_angles(evaluate(truth, truth));
  for (std::size_t i = 0; i < truth.size(); ++i) expect_angles(found.truth[i], angles(static_cast<double>(i) / 60.0));
}

TEST(CameraAngles, WithoutAVerticalAreThoseFromTheFirstPose) {
  const auto angles = [](double s) { return Expected{10.0 * s, 20.0 * s, -30.0 * s}; };
  const Eigen::Isometry3d aslant(Eigen::AngleAxisd(54.7 * degree, Eigen::Vector3d(1.0, -1.0, 0.0).normalized()));
  const Trajectory truth = test::moved(turning(angles), aslant);
  const Evaluation evaluation = evaluate(truth, truth);
  ASSERT_LT(evaluation.mean_up.cwiseAbs().maxCoeff(), 0.7) << "the case is none";
  const EvaluatedAngles found = camera_angles(evaluation);
  for (std::size_t i = 0; i < truth.size(); ++i) expect_angles(found.truth[i], angles(static_cast<double>(i) / 60.0));
}

/// The points of the last line of a plot, which is the truth's, in pixels.
std::vector<std::pair<double, double>> points_of_truth(const std::string& svg) {
  const std::string head = "<path d=\"";
  std::istringstream path(svg.substr(svg.rfind(head) + head.size()));
  std::vector<std::pair<double, double>> points;
  char letter = ' ';
  for (double x = 0.0, y = 0.0; path >> letter && (letter == 'M' || letter == 'L') && path >> x >> y;)
    points.emplace_back(x, y);
  return points;
}

TEST(CameraAngles, ArePlottedInDegreesWithoutJumps) {
  const Trajectory truth = turning([](double s) { return Expected{0.0, 0.0, 400.0 * s}; });
  const std::string svg = angle_over_time_svg(evaluate(truth, truth), 2);
  for (const char* tick : {">0<", ">200<", ">400<", ">yaw [deg]<"}) EXPECT_THAT(svg, ::testing::HasSubstr(tick));
  const auto points = points_of_truth(svg);
  ASSERT_GT(points.size(), 50u);
  const auto [x0, y0] = points.front();
  const auto [x1, y1] = points.back();
  EXPECT_LT(y1, y0 - 50.0) << "to the right is up";
  for (const auto& [x, y] : points) EXPECT_NEAR(y, y0 + (y1 - y0) * (x - x0) / (x1 - x0), 0.2) << "a straight line";
}

}  // namespace
}  // namespace holdfast
