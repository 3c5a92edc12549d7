// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/inertial_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace holdfast {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The samples of a frame at `end`, of a body that turns, at 200 Hz with one beyond each end.
SensorFrame frame_from(double begin, double end) {
  SensorFrame frame;
  frame.timestamp = end;
  for (double time = begin - 0.005; time < end + 0.0051; time += 0.005)
    frame.imu.push_back({time, Eigen::Vector3d(0.0, 0.1, 0.0), Eigen::Vector3d(0.0, -standard_gravity, 0.0)});
  return frame;
}

MapInertia estimates() {
  MapInertia result;
  result.gravity = {0.0, standard_gravity, 0.0};
  return result;
}

class InertialHistoryTest : public testing::Test {
 protected:
  InertialHistoryTest() { history.set_estimates(estimates(), 0); }
  void add(double begin, double end) {
    for (double time = begin; time + 0.05 < end + 1e-9; time += 0.1) history.add(frame_from(time, time + 0.1));
  }
  std::vector<InertialHistory::Link> links(std::vector<double> timestamps) { return history.links(timestamps); }

  InertialHistory history{*find_imu("bmi055")};
};

TEST_F(InertialHistoryTest, LinksSuccessiveTimesInTheirOrder) {
  add(0.0, 3.0);
  const auto found = links({2.0, 0.5, nan, 1.0});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].first, 1U);
  EXPECT_EQ(found[0].second, 3U);
  EXPECT_EQ(found[1].first, 3U);
  EXPECT_EQ(found[1].second, 0U);
  EXPECT_NEAR(found[0].measured.duration(), 0.5, 1e-9);
  EXPECT_NEAR(Eigen::AngleAxisd(found[1].measured.delta().rotation).angle(), 0.1, 1e-9);
}

/// A keyframe that is culled leaves one link over both intervals.
TEST_F(InertialHistoryTest, LinksOverACulledKeyframe) {
  add(0.0, 3.0);
  const auto found = links({0.5, 2.0});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].measured.duration(), 1.5, 1e-9);
}

TEST_F(InertialHistoryTest, DoesNotLinkOverGapsAndSaturation) {
  add(0.0, 1.0);
  add(1.5, 4.0);
  SensorFrame saturated = frame_from(4.0, 4.1);
  saturated.imu[5].acceleration.x() = 1000.0;
  history.add(saturated);
  add(4.1, 12.0);
  const auto found = links({0.5, 0.9, 1.6, 2.0, 5.0, 11.0});
  ASSERT_EQ(found.size(), 2U) << "a gap at 1 s, saturation at 4 s, and 6 s without a keyframe";
  EXPECT_EQ(found[0].second, 1U);
  EXPECT_EQ(found[1].first, 2U);
}

/// Sources give one sample before the first frame, which a time offset makes too late.
TEST_F(InertialHistoryTest, LinksTheFirstFrameAcrossAMissingSample) {
  add(0.0, 1.0);
  MapInertia earlier = estimates();
  earlier.time_offset = -0.012;
  history.set_estimates(earlier, 0);
  ASSERT_EQ(links({0.0, 0.5}).size(), 1U);
  EXPECT_NEAR(links({0.0, 0.5})[0].measured.duration(), 0.5, 1e-9);
  earlier.time_offset = -0.02;
  history.set_estimates(earlier, 0);
  EXPECT_TRUE(links({0.0, 0.5}).empty());
}

TEST_F(InertialHistoryTest, KeepsTheLastEstimatesOfASubmap) {
  add(0.0, 3.0);
  history.set_estimates(std::nullopt, 0);
  EXPECT_EQ(links({0.5, 1.0}).size(), 1U);
  history.set_estimates(std::nullopt, 1);
  EXPECT_TRUE(links({0.5, 1.0}).empty()) << "gravity in another world is unknown";
  history.set_estimates(std::nullopt, 0);
  EXPECT_EQ(links({0.5, 1.0}).size(), 1U) << "back in the first world";
  history.forget_map();
  EXPECT_TRUE(links({0.5, 1.0}).empty()) << "the new map has another world";
}

TEST_F(InertialHistoryTest, ForgetsEstimatesOfAnotherCalibration) {
  add(0.0, 3.0);
  InertialHistory other(*find_imu("bmi055"));
  other.add(frame_from(0.0, 3.0));
  MapInertia turned = estimates();
  turned.T_body_camera.linear() = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  other.set_estimates(turned, 0);
  EXPECT_TRUE(other.links(std::vector<double>{0.5, 1.0}).empty());
  other.set_estimates(estimates(), 0);
  EXPECT_EQ(other.links(std::vector<double>{0.5, 1.0}).size(), 1U);
}

/// A single measurement gives position and velocity one error in common.
TEST_F(InertialHistoryTest, DoesNotLinkOverASingleMeasurement) {
  add(0.0, 3.0);
  EXPECT_TRUE(links({0.5005, 0.5035}).empty());
  EXPECT_EQ(links({0.5005, 0.5135}).size(), 1U);
}

/// Keyframes of an earlier run, whose clock ran through the same times.
TEST_F(InertialHistoryTest, LinksKeyframesOfThisRunAlone) {
  Map map;
  std::vector<KeyFrameId> keyframes;
  for (const double time : {1.2, 1.0, 1.5}) {
    Frame frame;
    frame.timestamp = time;
    keyframes.push_back(map.add_keyframe(frame));
  }
  InertialHistory continued(*find_imu("bmi055"), 1);
  const std::vector<double> stamps = linkable_stamps(map, keyframes, continued);
  EXPECT_TRUE(std::isnan(stamps[0]));
  EXPECT_EQ(stamps[1], 1.0);
  EXPECT_EQ(stamps[2], 1.5);
  continued.forget_map();
  EXPECT_EQ(linkable_stamps(map, keyframes, continued)[0], 1.2);
}

/// The camera was seen `time_offset` after the state of the body.
TEST_F(InertialHistoryTest, TakesTheMeasurementsAtTheTimeOffset) {
  for (double time = 0.0; time < 2.0; time += 0.1) {
    SensorFrame frame = frame_from(time, time + 0.1);
    for (ImuSample& sample : frame.imu) sample.angular_velocity.y() = sample.timestamp;
    history.add(frame);
  }
  MapInertia shifted = estimates();
  shifted.time_offset = 0.1;
  history.set_estimates(shifted, 0);
  const auto found = links({0.5, 1.0});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(Eigen::AngleAxisd(found[0].measured.delta().rotation).angle(), 0.5 * 0.85, 1e-6);
}

TEST_F(InertialHistoryTest, AddsAChainWithOnePriorAndVelocitiesThatFollowFromThePoses) {
  add(0.0, 4.0);
  BundleProblem problem;
  for (int i = 0; i < 4; ++i) {
    Eigen::Isometry3d T_world_camera(Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d::UnitY()));
    T_world_camera.translation() = Eigen::Vector3d(0.2 * i, 0.0, 0.0);  // 0.4 m/s
    problem.poses.push_back({T_world_camera.inverse(), i < 2});
  }
  const std::vector<std::uint8_t> linked = add_inertial_factors(problem, links({1.0, 1.5, 2.0, 2.5}), estimates());
  EXPECT_EQ(linked, (std::vector<std::uint8_t>{0, 1, 1, 1})) << "nothing is free between the first two";
  ASSERT_EQ(problem.factors.motions.size(), 3U);
  EXPECT_EQ(problem.factors.inertial.size(), 2U);
  EXPECT_EQ(problem.factors.motion_priors.size(), 1U);
  for (const BundleFactors::Motion& motion : problem.factors.motions)
    EXPECT_LT((motion.velocity - Eigen::Vector3d(0.4, 0.0, 0.0)).norm(), 1e-6);
  EXPECT_TRUE(problem.factors.scale_fixed);
}

/// Tracking that knows the biases badly must not hold them more firmly than it can.
TEST_F(InertialHistoryTest, BiasPriorsAreAsWideAsTheEstimatesAtLeast) {
  add(0.0, 3.0);
  for (const double deviation : {0.0001, 0.02}) {
    MapInertia known = estimates();
    known.gyroscope_deviation = deviation;
    known.accelerometer_deviation = 10.0 * deviation;
    history.set_estimates(known, 0);
    BundleProblem problem;
    problem.poses.assign(2, {Eigen::Isometry3d::Identity(), false});
    add_inertial_factors(problem, links({0.5, 2.0}), *history.estimates());
    ASSERT_EQ(problem.factors.motion_priors.size(), 1U);
    const auto& information = problem.factors.motion_priors.front().information;
    EXPECT_NEAR(1.0 / std::sqrt(information(3, 3)), std::max(deviation, 0.003), 1e-9);
    EXPECT_NEAR(1.0 / std::sqrt(information(8, 8)), std::max(10.0 * deviation, 0.03), 1e-9);
  }
}

}  // namespace
}  // namespace holdfast
