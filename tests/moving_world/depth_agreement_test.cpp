// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/depth_agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "holdfast/geometry/se3.hpp"
#include "support/box_world.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::BoxWorld;

BoxWorld furnished_room() {
  BoxWorld world;
  world.floor_y = 1.2;
  world.boxes = {BoxWorld::box({-1.2, 0.6, 2.4}, {0.3, 0.6, 0.3}), BoxWorld::box({0.2, 0.9, 2.2}, {0.4, 0.3, 0.3}),
                 BoxWorld::box({1.2, -0.3, 2.7}, {0.3, 0.4, 0.3}), BoxWorld::box({-0.4, -0.8, 2.8}, {0.5, 0.15, 0.2})};
  return world;
}
BoxWorld with_person(double x) {
  BoxWorld world = furnished_room();
  world.boxes.push_back(BoxWorld::box({x, 0.2, 1.5}, {0.3, 1.0, 0.12}));
  return world;
}

Isometry3d pose(double degrees, const Vector3d& place) {
  Isometry3d T_world_camera = Isometry3d::Identity();
  T_world_camera.linear() = Eigen::AngleAxisd(degrees * 0.017453292519943295, Vector3d::UnitY()).toRotationMatrix();
  T_world_camera.translation() = place;
  return T_world_camera;
}
const Isometry3d origin = Isometry3d::Identity();

/// A map of keyframes from the origin, all of which see the same points.
class DepthAgreementTest : public testing::Test {
 protected:
  KeyFrameId keyframe(const BoxWorld& world, double timestamp) {
    const KeyFrameId id = map.add_keyframe(world.frame(origin, timestamp, 40));
    for (std::uint32_t i = 0; i < map.keyframe(id).frame.size(); ++i) {
      if (points.size() <= i) points.push_back(map.add_point(map.keyframe(id).frame.camera_point(i), 0));
      map.add_observation(points[i], id, i);
    }
    map.update_covisibility(id);
    return id;
  }

  Map map;
  std::vector<MapPointId> points;
  DepthAgreement agreement;
};

TEST_F(DepthAgreementTest, WithoutAKeyframeThereIsNothingToCompareWith) {
  EXPECT_FALSE(agreement.choose(map, KeyFrameId(), 1.0));
  const Frame frame = furnished_room().frame(origin, 1.0);
  EXPECT_EQ(agreement.agreeing_share(frame, origin), 0.0);
  Frame blind = furnished_room().frame(origin, 0.0, 40);
  blind.coarse.depth.clear();
  EXPECT_FALSE(agreement.choose(map, map.add_keyframe(std::move(blind)), 1.0));
}

TEST_F(DepthAgreementTest, TheTruePoseAgreesBest) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  for (const Isometry3d& T_world_camera : {origin, pose(6, {0.1, 0.0, 0.05}), pose(-5, {-0.15, 0.1, 0.2})}) {
    const Frame frame = furnished_room().frame(T_world_camera, 2.0);
    const Isometry3d truth = T_world_camera.inverse();
    const double best = agreement.agreeing_share(frame, truth);
    EXPECT_GE(best, 0.9);
    for (const double sign : {-1.0, 1.0}) {
      for (const Isometry3d& error : {pose(2 * sign, Vector3d::Zero()), pose(0, {0, 0, 0.05 * sign}),
                                      pose(0, {0.1 * sign, 0, 0}), pose(0, {0, 0.1 * sign, 0})})
        EXPECT_LE(agreement.agreeing_share(frame, error * truth), best - 0.02);
      EXPECT_LE(agreement.agreeing_share(frame, pose(0, {0, 0, 0.1 * sign}) * truth), 0.2);
    }
  }
}

TEST_F(DepthAgreementTest, PeopleLeaveTheRoomToDecide) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  const Isometry3d T_world_camera = pose(3, {0.1, 0, 0});
  const Frame frame = with_person(0.1).frame(T_world_camera, 2.0);
  const double share = agreement.agreeing_share(frame, T_world_camera.inverse());
  EXPECT_GE(share, 0.6);
  EXPECT_LE(share, 0.9);
  EXPECT_GE(share, agreement.agreeing_share(frame, pose(2, {0, 0, 0}) * T_world_camera.inverse()) + 0.02);
}

TEST_F(DepthAgreementTest, OldKeyframesAreBelievedRatherThanYoungOnes) {
  // The young one saw the person who still stands there.
  const KeyFrameId young = keyframe(with_person(0.0), 1.8);
  const Frame frame = with_person(0.0).frame(origin, 2.0);
  ASSERT_TRUE(agreement.choose(map, young, 2.0));
  EXPECT_GE(agreement.agreeing_share(frame, origin), 0.99);  // there is no other
  const KeyFrameId old = keyframe(furnished_room(), 1.0);
  ASSERT_TRUE(agreement.choose(map, young, 2.0));
  const double share = agreement.agreeing_share(frame, origin);
  EXPECT_LE(share, 0.9);
  // The young one had no part in it.
  Map without;
  const KeyFrameId alone = without.add_keyframe(map.keyframe(old).frame);
  ASSERT_TRUE(agreement.choose(without, alone, 2.0));
  EXPECT_EQ(agreement.agreeing_share(frame, origin), share);
}

TEST_F(DepthAgreementTest, WhatMovedInAKeyframeDoesNotCount) {
  const KeyFrameId id = keyframe(with_person(0.0), 0.0);
  const Frame frame = furnished_room().frame(origin, 2.0);
  ASSERT_TRUE(agreement.choose(map, id, 2.0));
  EXPECT_LE(agreement.agreeing_share(frame, origin), 0.9);
  CoarseView& view = map.keyframe(id).frame.coarse;
  for (const float depth : view.depth) view.static_log_odds.push_back(depth < 1.6F ? -1.0F : 0.0F);
  EXPECT_GE(agreement.agreeing_share(frame, origin), 0.99);
}

TEST_F(DepthAgreementTest, TooLittleInCommonIsNoAgreement) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  const Frame frame = furnished_room().frame(origin, 2.0);
  EXPECT_EQ(agreement.agreeing_share(frame, pose(120, Vector3d::Zero())), 0.0);
  const auto share_of_rows = [&](int rows) {
    Frame nearly_blind = frame;
    std::fill(nearly_blind.coarse.depth.begin() + rows * frame.coarse.grid.columns, nearly_blind.coarse.depth.end(),
              0.0F);
    return agreement.agreeing_share(nearly_blind, origin);
  };
  EXPECT_EQ(share_of_rows(5), 0.0);
  EXPECT_GE(share_of_rows(12), 0.99);
}

TEST_F(DepthAgreementTest, FindsWhereOnTheWayTheDepthWasTaken) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  const Isometry3d T_camera_world = pose(2, {0.05, 0, 0}).inverse();
  const Isometry3d step = pose(4, {0.05, 0.02, 0.12});
  for (const double steps : {0.0, 0.4, -0.6, 0.8}) {
    const Isometry3d T_view_camera = geometry::exp_se3(steps * geometry::log_se3(step));
    const Frame frame = furnished_room().frame((T_view_camera * T_camera_world).inverse(), 2.0);
    const Isometry3d found =
        agreement.find_view(frame, T_camera_world, agreement.agreeing_share(frame, T_camera_world), step);
    const double found_steps = geometry::log_se3(found).norm() / geometry::log_se3(step).norm();
    EXPECT_NEAR(found_steps, std::abs(steps), 0.05) << steps;
    EXPECT_LE((found.translation() - T_view_camera.translation()).norm(), 0.05 * step.translation().norm()) << steps;
  }
}

TEST_F(DepthAgreementTest, ASupportedPoseMayBeOccludedButMustNotSeeThroughSurfaces) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  const Frame frame = with_person(0.1).frame(origin, 2.0);
  EXPECT_LE(agreement.agreeing_share(frame, origin), 0.9);
  EXPECT_GE(agreement.unoccluded_share(frame, origin), 0.98);
  EXPECT_LE(agreement.unoccluded_share(frame, pose(0, {0, 0, 0.15})), 0.6);
  EXPECT_LE(agreement.unoccluded_share(frame, pose(0, {0, 0, -0.15})), 0.6);
  Frame blind = frame;
  std::fill(blind.coarse.depth.begin(), blind.coarse.depth.end(), 0.0F);
  EXPECT_EQ(agreement.unoccluded_share(blind, origin), 0.0);
}

TEST_F(DepthAgreementTest, DepthAloneFindsThePose) {
  ASSERT_TRUE(agreement.choose(map, keyframe(furnished_room(), 0.0), 2.0));
  for (const bool has_person : {false, true})
    for (const Isometry3d& T_world_camera : {origin, pose(6, {0.1, 0.0, 0.05}), pose(-5, {-0.15, 0.1, 0.2})}) {
      const Frame frame = (has_person ? with_person(0.1) : furnished_room()).frame(T_world_camera, 2.0);
      const Isometry3d truth = T_world_camera.inverse();
      for (const double sign : {-1.0, 1.0}) {
        const Isometry3d predicted = pose(2 * sign, {0.02 * sign, -0.02, 0.03 * sign}) * truth;
        const Isometry3d error = agreement.align(frame, predicted) * T_world_camera;
        EXPECT_LE(error.translation().norm(), 0.01) << has_person;
        EXPECT_LE(geometry::log_so3(Eigen::Matrix3d(error.linear())).norm(), 0.004) << has_person;
      }
    }
}

TEST_F(DepthAgreementTest, WhatDepthDoesNotDetermineStaysAsPredicted) {
  // Above a bare floor, depth determines the height and two angles.
  BoxWorld floor;
  floor.floor_y = 1.2;
  ASSERT_TRUE(agreement.choose(map, keyframe(floor, 0.0), 2.0));
  const Frame frame = floor.frame(origin, 2.0);
  const Isometry3d found = agreement.align(frame, pose(0, {0.02, 0.03, 0.0}));
  EXPECT_NEAR(found.translation().x(), 0.02, 0.003);
  EXPECT_NEAR(found.translation().y(), 0.0, 0.005);
}

}  // namespace
}  // namespace holdfast
