// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/gait.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "holdfast/simulation/footsteps.hpp"
#include "holdfast/simulation/limbs.hpp"
#include "holdfast/simulation/route.hpp"
#include "holdfast/simulation/swing.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(Route, KeepsToStraightsRoundsCornersAndTurnsGently) {
  const Route route({{0, 0}, {4, 0}, {4, 0}, {4, 3}});
  EXPECT_LT(route.length(), 7.0);
  EXPECT_GT(route.length(), 6.5);
  EXPECT_TRUE(route.position(0.0).isZero());
  EXPECT_TRUE(route.position(route.length()).isApprox(Vector2d(4, 3), 1e-9));
  EXPECT_TRUE(route.position(route.length() + 1.0).isApprox(Vector2d(4, 4), 1e-9));
  EXPECT_NEAR(route.heading(1.0), heading_of({1, 0}), 1e-9);
  for (double s = 0.0; s < route.length(); s += 0.01) {
    EXPECT_NEAR((route.position(s + 0.01) - route.position(s)).norm(), 0.01, 1e-5);
    EXPECT_NEAR(route.heading(s + 0.01) - route.heading(s), 0.0, 0.012 / Route::usual_radius);
    // The corner is cut by less than what the radius allows.
    const Vector2d place = route.position(s);
    EXPECT_LT(std::min(std::abs(place.y()), std::abs(place.x() - 4.0)), 0.18);
  }
}

TEST(Route, IsCutWhereOneWouldTurnOnTheSpot) {
  EXPECT_EQ(Route::legs({{0, 0}, {2, 0}, {4, 1}}).size(), 1U);
  EXPECT_EQ(Route::legs({{0, 0}, {2, 0}, {0, 0.1}}).size(), 2U);
  EXPECT_TRUE(Route::legs({{1, 1}, {1, 1}}).empty());
}

TEST(Travel, StartsAndEndsAtRestAndInverts) {
  const Route route({{0, 0}, {5, 0}, {5, 4}});
  const Travel travel(route, route.length(), 1.2);
  EXPECT_EQ(travel.distance(-1.0), 0.0);
  EXPECT_NEAR(travel.distance(travel.duration()), route.length(), 1e-9);
  EXPECT_NEAR(travel.duration(), route.length() / 1.2 + 1.2, 0.6);
  double fastest = 0.0;
  for (double time = 0.01; time < travel.duration(); time += 0.013) {
    EXPECT_NEAR(travel.time(travel.distance(time)), time, 1e-6);
    EXPECT_NEAR(travel.speed(time), (travel.distance(time + 1e-5) - travel.distance(time - 1e-5)) / 2e-5, 1e-3);
    EXPECT_LE(travel.speed(time + 0.01) - travel.speed(time), 0.01001);
    EXPECT_LT(travel.speed(time) * std::abs(route.curvature(travel.distance(time))), 2.1);
    fastest = std::max(fastest, travel.speed(time));
  }
  EXPECT_NEAR(fastest, 1.2, 1e-9);
}

TEST(Limbs, FootAndHandComeWhereTheyAreWanted) {
  const Skeleton skeleton({1.8, 1.1});
  Posture posture = skeleton.standing();
  posture.pelvis.z() -= 0.1;
  const Isometry3d T_person_pelvis(Eigen::Translation3d(posture.pelvis));
  const Vector3d ankle(0.12, -0.3, 0.15), point(-0.2, -0.4, 1.1);
  const Quaterniond foot(Eigen::AngleAxisd(0.3, Vector3d(0.2, 0.1, 1.0).normalized()));
  place_foot(skeleton, T_person_pelvis, Side::left, ankle, foot, posture);
  const Isometry3d chest = skeleton.place(posture)[index(Bone::chest)];
  reach(skeleton, chest, Side::right, hand_on(skeleton, Side::right, point, Vector3d(1, 0, 0), Vector3d(0, -1, -0.3)),
        1.0, posture);
  const BonePoses poses = skeleton.place(posture);
  EXPECT_LT((poses[index(Bone::left_foot)].translation() - ankle).norm(), 1e-9);
  EXPECT_LT(Quaterniond(poses[index(Bone::left_foot)].linear()).angularDistance(foot), 1e-7);
  EXPECT_LT((palm_of(skeleton, Side::right, poses[index(Bone::right_hand)]) - point).norm(), 1e-9);
  // Fingers forward: the hand's -z; knee to the front, elbow to the back.
  EXPECT_LT(poses[index(Bone::right_hand)].linear().col(2).dot(Vector3d(0, -1, -0.3)), -1.0);
  EXPECT_LT(poses[index(Bone::left_shin)].translation().y(), -0.1);
  EXPECT_GT(poses[index(Bone::right_forearm)].translation().y(), point.y());
}

TEST(Footsteps, StandStillLandOnTheHeelAndLeaveOverTheToes) {
  const Skeleton skeleton({1.75, 1.0});
  FootTrack track(skeleton, {0, 0}, 0.0);
  track.step({.lifted = 1.0, .landed = 1.4, .position = {0, -1.2}, .heading = 0.1, .push = 0.6, .strike = 0.3});
  track.step({.lifted = 2.1, .landed = 2.5, .position = {0, -2.4}, .heading = 0.0, .push = 0.6, .strike = 0.3});
  const double toe = -0.75 * skeleton.length(Bone::left_foot), heel = 0.25 * skeleton.length(Bone::left_foot);
  const auto sole = [&](double time, double y) -> Vector3d {
    const FootPose pose = track.pose(time);
    return pose.ankle + pose.rotation() * Vector3d(0, y, -skeleton.ankle_height());
  };
  EXPECT_LT((sole(0.999, toe) - sole(0.0, toe)).norm(), 1e-12);
  EXPECT_GT(sole(0.999, heel).z(), 0.1);
  EXPECT_LT((sole(1.401, heel) - sole(1.6, heel)).norm(), 1e-12);
  EXPECT_GT(sole(1.401, toe).z(), 0.05);
  EXPECT_TRUE(track.pose(1.6).planted);
  EXPECT_FALSE(track.pose(1.2).planted);
  for (double time = 0.9; time < 2.7; time += 0.001) {
    EXPECT_GT(std::min(sole(time, toe).z(), sole(time, heel).z()), -1e-9) << time;
    const Vector3d before = track.pose(time).ankle, at = track.pose(time + 1e-3).ankle,
                   after = track.pose(time + 2e-3).ankle;
    EXPECT_LT((after - 2.0 * at + before).norm(), 2e-4) << time;  // speeds differ by less than 0.2 m/s in 1 ms
  }
}

TEST(Gait, ArmsSwingAgainstLegsAndTheHeadStaysSteady) {
  const Skeleton skeleton({1.75, 1.0});
  const Style style;
  double most = 0.0;
  for (double steps = 0.0; steps < 2.0; steps += 0.05) {
    Posture posture = skeleton.standing();
    add_gait({.steps = steps, .first_side = 1.0, .amplitude = 1.0, .speed = 1.3}, style, posture);
    const BonePoses poses = skeleton.place(posture);
    const double left = poses[index(Bone::left_hand)].translation().y(),
                 right = poses[index(Bone::right_hand)].translation().y();
    most = std::max(most, std::abs(left - right));
    const Eigen::Matrix3d head = poses[index(Bone::head)].linear();
    EXPECT_LT(Eigen::AngleAxisd(head).angle(), 0.07) << steps;
    EXPECT_LT(std::abs(std::atan2(head(1, 0), head(0, 0))), 0.03) << steps;
    if (std::abs(steps - 0.55) < 1e-6) {
      EXPECT_GT(left, right + 0.2) << "the left arm is back when the left foot lands";
      EXPECT_LT(poses[index(Bone::left_thigh)].translation().y(), poses[index(Bone::right_thigh)].translation().y());
    }
    if (std::abs(steps - 1.0) < 1e-6) {
      EXPECT_GT(posture.pelvis.x(), 0.01);
      EXPECT_GT(poses[index(Bone::left_thigh)].translation().z(), poses[index(Bone::right_thigh)].translation().z());
    }
  }
  EXPECT_GT(most, 0.25);
  EXPECT_LT(most, 0.7);
}

TEST(Gait, StepsGrowWithHeightAndSpeed) {
  EXPECT_NEAR(step_length(1.75, 1.33), 0.70, 0.01);
  EXPECT_GT(step_length(1.75, 1.5), step_length(1.75, 1.0));
  EXPECT_GT(step_length(1.9, 1.0), step_length(1.6, 1.0));
}

TEST(Gesture, RaisesBothHandsAndMovesThem) {
  const Skeleton skeleton({1.75, 1.0});
  const Style style(Random(4));
  double lowest = 9.0, highest = 0.0, moved = 0.0;
  Vector3d before = Vector3d::Zero();
  for (double time = 0.0; time < 30.0; time += 0.1) {
    Posture posture = skeleton.standing();
    add_gait({}, style, posture);
    const double hanging = skeleton.place(posture)[index(Bone::left_hand)].translation().z();
    add_gesture(time, style, 1.0, posture);
    const Vector3d hand = skeleton.place(posture)[index(Bone::left_hand)].translation();
    EXPECT_GT(hand.z(), hanging);
    EXPECT_LT(hand.y(), 0.0) << "before the body";
    lowest = std::min(lowest, hand.z());
    highest = std::max(highest, hand.z());
    if (time > 0) moved += (hand - before).norm();
    before = hand;
  }
  EXPECT_GT(highest - lowest, 0.2);
  EXPECT_GT(moved, 3.0);
  EXPECT_LT(moved, 30.0);
}

TEST(Swing, OpensStaysOpenAndCloses) {
  const SwingPlan plan;
  EXPECT_EQ(swing_angle(plan, 1.9), 0.0);
  EXPECT_NEAR(swing_angle(plan, 2.75), 0.5 * plan.angle, 1e-9);
  EXPECT_NEAR(swing_angle(plan, 4.5), plan.angle, 1e-9);
  EXPECT_NEAR(swing_angle(plan, 8.0), 0.0, 1e-9);
  EXPECT_NEAR(swing_angle(plan, 2.0 + 8.0 + 0.75), 0.5 * plan.angle, 1e-9) << "and again";
  for (double time = 0.0; time < 25.0; time += 0.001)
    ASSERT_LT(std::abs(swing_angle(plan, time + 0.001) - swing_angle(plan, time)), 0.002);
  Isometry3d hinge(Eigen::Translation3d(1, 2, 0));
  const Isometry3d open = swing_motion(plan, hinge)(4.5);
  EXPECT_TRUE(open.translation().isApprox(hinge.translation()));
  EXPECT_NEAR(open.linear()(1, 0), std::sin(plan.angle), 1e-9);
}

}  // namespace
}  // namespace holdfast::simulation
