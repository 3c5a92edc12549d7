// SPDX-License-Identifier: BSD-3-Clause
#include "multi_view_depth.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "holdfast/core/random.hpp"
#include "support/box_world.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::BoxWorld;

constexpr double now = 20.0;
constexpr std::uint8_t person = 9;

BoxWorld furnished_room() {
  BoxWorld world;
  world.floor_y = 1.2;
  world.boxes = {BoxWorld::box({-1.2, 0.6, 2.4}, {0.3, 0.6, 0.3}), BoxWorld::box({0.2, 0.9, 2.2}, {0.4, 0.3, 0.3}),
                 BoxWorld::box({1.2, -0.3, 2.7}, {0.3, 0.4, 0.3}), BoxWorld::box({-0.4, -0.8, 2.8}, {0.5, 0.15, 0.2})};
  return world;
}
BoxWorld with_person() {
  BoxWorld world = furnished_room();
  world.boxes.push_back(BoxWorld::box({0.1, 0.1, 1.6}, {0.25, 0.6, 0.12}, person));
  return world;
}

Isometry3d pose(double degrees, const Vector3d& place, const Vector3d& axis = Vector3d::UnitY()) {
  Isometry3d T_world_camera = Isometry3d::Identity();
  T_world_camera.linear() = Eigen::AngleAxisd(degrees * 0.017453292519943295, axis.normalized()).toRotationMatrix();
  T_world_camera.translation() = place;
  return T_world_camera;
}

class MultiViewDepthTest : public testing::Test {
 protected:
  KeyFrameId keyframe(const BoxWorld& world, double age, const Isometry3d& T_world_camera) {
    return map.add_keyframe(world.frame(T_world_camera, now - age));
  }
  /// Keyframes of every age that saw a world.
  void remember(const BoxWorld& world) {
    keyframe(world, 12.0, pose(2, {0.05, 0, 0}));
    keyframe(world, 5.0, pose(-3, {-0.1, 0.02, 0}));
    keyframe(world, 2.0, pose(1, {0, 0, 0.1}));
    keyframe(world, 0.4, pose(0, {0.02, 0.01, 0}));
  }
  StaticEvidence evaluate(const Frame& frame, const Isometry3d* T_camera_world,
                          const MultiViewDepthSettings& settings = {}) {
    multi_view_depth_plugin::MultiViewDepth filter(settings, {});
    StaticEvidence evidence(frame.size(), frame.coarse.depth.size());
    evidence.begin_stage("multi_view_depth");
    const SensorFrame image;
    filter.apply({.sensor_frame = image, .frame = frame, .map = map, .T_camera_world = T_camera_world}, evidence);
    return evidence;
  }
  /// Shares of the features on the person, and of the others, about which something negative or positive was said.
  struct Shares {
    double person_moves, person_stays, room_moves, room_stays;
  };
  static Shares shares(const Frame& frame, const BoxWorld& world, const StaticEvidence& evidence) {
    int on_person = 0, on_room = 0, counts[4] = {};
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const bool is_person = world.look(frame.T_world_camera(), frame.x[i], frame.y[i]).label == person;
      ++(is_person ? on_person : on_room);
      const float said = evidence.measurement(i);
      if (said < 0) ++counts[is_person ? 0 : 2];
      if (said > 0) ++counts[is_person ? 1 : 3];
    }
    const auto share = [](int part, int all) { return all == 0 ? 0.0 : static_cast<double>(part) / all; };
    return {share(counts[0], on_person), share(counts[1], on_person), share(counts[2], on_room),
            share(counts[3], on_room)};
  }

  Map map;
};

TEST_F(MultiViewDepthTest, OutlinesAreSuspectAndSoIsTheUnknownInACrowd) {
  remember(furnished_room());
  const BoxWorld world = with_person();
  const Frame frame = world.frame(pose(0, {0, 0, 0}), now);
  const auto suspects = [&](const MultiViewDepthSettings& settings) {
    const StaticEvidence evidence = evaluate(frame, &frame.T_camera_world, settings);
    int count = 0;
    for (std::size_t i = 0; i < frame.size(); ++i) count += evidence.prior(i) < 0.0F ? 1 : 0;
    return count;
  };
  EXPECT_EQ(suspects({.edge_log_odds = 0.0, .crowd_log_odds = 0.0}), 0);
  const int at_outline = suspects({.crowd_log_odds = 0.0});
  EXPECT_GT(at_outline, 0);
  EXPECT_LT(at_outline, static_cast<int>(frame.size() / 4));
  EXPECT_GT(suspects({.edge = 12.0, .crowd_log_odds = 0.0}), at_outline);
}

TEST_F(MultiViewDepthTest, WhatStandsWhereOthersSawThroughMoves) {
  remember(furnished_room());
  const BoxWorld world = with_person();
  for (const Isometry3d& T_world_camera : {pose(0, {0, 0, 0}), pose(4, {0.1, -0.05, 0.1})}) {
    const Frame frame = world.frame(T_world_camera, now);
    const Shares said = shares(frame, world, evaluate(frame, &frame.T_camera_world));
    EXPECT_GE(said.person_moves, 0.98);
    EXPECT_EQ(said.person_stays, 0.0);
    EXPECT_LE(said.room_moves, 0.01);
    EXPECT_GE(said.room_stays, 0.9);
  }
}

TEST_F(MultiViewDepthTest, CellsSayTheSameAsFeatures) {
  remember(furnished_room());
  const BoxWorld world = with_person();
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  const StaticEvidence evidence = evaluate(frame, &frame.T_camera_world);
  std::vector<std::uint8_t> labels;
  world.view(Isometry3d::Identity(), &labels);
  int on_person = 0, moving = 0, others_moving = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    on_person += labels[i] == person ? 1 : 0;
    if (evidence.cells()[i] < 0) ++(labels[i] == person ? moving : others_moving);
  }
  EXPECT_GE(moving, on_person * 95 / 100);
  EXPECT_LE(others_moving, on_person * 5 / 100);
}

TEST_F(MultiViewDepthTest, AnErrorOfThePredictedPoseMakesNoMovement) {
  remember(furnished_room());
  const BoxWorld world = furnished_room();
  Random random(4);
  const auto direction = [&] { return Vector3d{random.normal(), random.normal(), random.normal()}.normalized(); };
  for (int trial = 0; trial < 20; ++trial) {
    const Frame frame = world.frame(pose(3, {0.05, 0.02, 0.05}), now);
    const Isometry3d predicted = pose(0.5, 0.01 * direction(), direction()) * frame.T_camera_world;
    const Shares said = shares(frame, world, evaluate(frame, &predicted));
    EXPECT_LT(said.room_moves, 0.02) << trial;
    EXPECT_GE(said.room_stays, 0.7) << trial;
  }
}

TEST_F(MultiViewDepthTest, EdgesOfThinThingsDoNotMoveWithASmallErrorOfThePose) {
  BoxWorld world;
  world.wall_z = 4.0;
  for (int i = -4; i <= 4; ++i) world.boxes.push_back(BoxWorld::box({0.3 * i, 0, 2.0}, {0.03, 2.0, 0.03}));
  remember(world);
  const Frame frame = world.frame(Isometry3d::Identity(), now, 4);
  for (const double sign : {-1.0, 1.0}) {
    const Isometry3d predicted = pose(0.15 * sign, {0.003 * sign, 0, 0}) * frame.T_camera_world;
    EXPECT_EQ(shares(frame, world, evaluate(frame, &predicted)).room_moves, 0.0);
  }
}

TEST_F(MultiViewDepthTest, PartsThatNoKeyframeSawBelongToWhatTheyGoOnFrom) {
  // Keyframes see half of where the person stands.
  for (const double age : {12.0, 5.0, 2.0, 0.4}) keyframe(furnished_room(), age, pose(13, {0, 0, 0}));
  BoxWorld world = furnished_room();
  world.boxes.push_back(BoxWorld::box({-0.5, 0.0, 1.6}, {0.2, 0.6, 0.12}, person));
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  EXPECT_GE(shares(frame, world, evaluate(frame, &frame.T_camera_world)).person_moves, 0.95);
  EXPECT_LE(shares(frame, world, evaluate(frame, &frame.T_camera_world, {.growth = 0})).person_moves, 0.8);
}

TEST_F(MultiViewDepthTest, WhatAPersonTouchesIsNotTakenAlong) {
  // A sideboard whose front goes on from the person's without a gap.
  const auto with_sideboard = [](BoxWorld world) {
    world.boxes.push_back(BoxWorld::box({0.65, 0.3, 1.6}, {0.3, 0.3, 0.12}, 3));
    return world;
  };
  remember(with_sideboard(furnished_room()));
  const BoxWorld world = with_sideboard(with_person());
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  const auto share_of_sideboard = [&](const MultiViewDepthSettings& settings) {
    const StaticEvidence evidence = evaluate(frame, &frame.T_camera_world, settings);
    int all = 0, moves = 0;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (world.look(Isometry3d::Identity(), frame.x[i], frame.y[i]).label != 3) continue;
      ++all;
      moves += evidence.measurement(i) < 0.0F ? 1 : 0;
    }
    return static_cast<double>(moves) / all;
  };
  EXPECT_LE(share_of_sideboard({}), 0.08);
  EXPECT_GE(share_of_sideboard({.confirmed_score = 10.0}), 0.35);
  EXPECT_GE(shares(frame, world, evaluate(frame, &frame.T_camera_world)).person_moves, 0.95);
}

TEST_F(MultiViewDepthTest, APersonIsStillFoundWithAnErrorOfThePredictedPose) {
  remember(furnished_room());
  const BoxWorld world = with_person();
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  for (const double sign : {-1.0, 1.0}) {
    const Isometry3d predicted = pose(0.5 * sign, {0.006, 0.006 * sign, 0.006}) * frame.T_camera_world;
    EXPECT_GE(shares(frame, world, evaluate(frame, &predicted)).person_moves, 0.95);
  }
}

TEST_F(MultiViewDepthTest, AYoungKeyframeDoesNotExcuseWhoJustStopped) {
  keyframe(furnished_room(), 12.0, pose(2, {0.05, 0, 0}));
  keyframe(furnished_room(), 5.0, pose(-3, {-0.1, 0.02, 0}));
  const BoxWorld world = with_person();
  keyframe(world, 0.4, pose(0, {0, 0, 0}));
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  EXPECT_GE(shares(frame, world, evaluate(frame, &frame.T_camera_world)).person_moves, 0.95);
}

TEST_F(MultiViewDepthTest, WhatMovedInAKeyframeIsNotConfirmedByIt) {
  const BoxWorld world = with_person();
  remember(world);
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  EXPECT_GE(shares(frame, world, evaluate(frame, &frame.T_camera_world)).person_stays, 0.9);
  for (const KeyFrameId id : map.keyframes_by_age()) {
    Frame& seen = map.keyframe(id).frame;
    std::vector<std::uint8_t> labels;
    world.view(seen.T_world_camera(), &labels);
    for (const std::uint8_t label : labels) seen.coarse.static_log_odds.push_back(label == person ? -2.0F : 1.0F);
  }
  const Shares said = shares(frame, world, evaluate(frame, &frame.T_camera_world));
  EXPECT_LE(said.person_stays, 0.1);
  EXPECT_LE(said.person_moves, 0.02);  // nobody saw through
  EXPECT_GE(said.room_stays, 0.9);
}

TEST_F(MultiViewDepthTest, MapPointsThatAreSeenThroughAreGone) {
  // The person was there when the points were made and has left.
  const BoxWorld before = with_person();
  const KeyFrameId id = keyframe(before, 2.0, Isometry3d::Identity());
  std::vector<MapPointId> on_person, on_room;
  for (std::uint32_t i = 0; i < map.keyframe(id).frame.size(); ++i) {
    const Frame& seen = map.keyframe(id).frame;
    const MapPointId point = map.add_point(seen.camera_point(i), 0);
    (before.look(Isometry3d::Identity(), seen.x[i], seen.y[i]).label == person ? on_person : on_room).push_back(point);
    map.add_observation(point, id, i);
  }
  ASSERT_GE(on_person.size(), 200U);
  const Frame frame = furnished_room().frame(pose(2, {0.03, 0.0, 0.02}), now);
  const StaticEvidence evidence = evaluate(frame, &frame.T_camera_world);
  std::size_t found = 0, wrong = 0;
  for (const StaticEvidence::PointContribution& statement : evidence.point_contributions()) {
    EXPECT_LT(statement.log_odds, 0.0F);
    const bool right = std::find(on_person.begin(), on_person.end(), statement.point) != on_person.end();
    ++(right ? found : wrong);
  }
  EXPECT_GE(found, on_person.size() * 9 / 10);
  EXPECT_EQ(wrong, 0U);
  // While the person stands there, and behind one who stands before them, points are left alone.
  for (const BoxWorld& world : {before, [] {
                                  BoxWorld nearer = furnished_room();
                                  nearer.boxes.push_back(BoxWorld::box({0.1, 0.1, 1.1}, {0.4, 0.7, 0.1}, person));
                                  return nearer;
                                }()}) {
    const Frame unchanged = world.frame(Isometry3d::Identity(), now);
    EXPECT_LE(evaluate(unchanged, &unchanged.T_camera_world).point_contributions().size(), on_person.size() / 20);
  }
  EXPECT_TRUE(evaluate(frame, &frame.T_camera_world, {.point_keyframes = 0}).point_contributions().empty());
}

TEST_F(MultiViewDepthTest, IsSilentWithoutKeyframesThatOverlapOrAPose) {
  const BoxWorld world = with_person();
  const Frame frame = world.frame(Isometry3d::Identity(), now);
  const auto is_silent = [&](const Isometry3d* T_camera_world) {
    const StaticEvidence evidence = evaluate(frame, T_camera_world);
    for (const float cell : evidence.cells())
      if (cell != 0.0F) return false;
    return evidence.contributions().empty() && evidence.point_contributions().empty();
  };
  EXPECT_TRUE(is_silent(&frame.T_camera_world));
  keyframe(furnished_room(), 5.0, pose(40, {0, 0, 0}));    // looks elsewhere
  keyframe(furnished_room(), 5.0, pose(0, {0, 0, -1.5}));  // from too far away
  EXPECT_TRUE(is_silent(&frame.T_camera_world));
  remember(furnished_room());
  EXPECT_TRUE(is_silent(nullptr));
  EXPECT_FALSE(is_silent(&frame.T_camera_world));
}

TEST_F(MultiViewDepthTest, TheDepthsOwnPoseCounts) {
  // Depth taken on the way, at another pose than the colour image's.
  remember(furnished_room());
  const BoxWorld world = furnished_room();
  const Isometry3d T_world_camera = Isometry3d::Identity(), T_world_view = pose(4, {0.06, 0, 0});
  Frame frame = world.frame(T_world_camera, now);
  frame.coarse = world.view(T_world_view);
  const auto moving_cells = [&] {
    const StaticEvidence evidence = evaluate(frame, &frame.T_camera_world);
    return std::count_if(evidence.cells().begin(), evidence.cells().end(), [](float cell) { return cell < 0.0F; });
  };
  EXPECT_GT(moving_cells(), 200);
  frame.coarse.T_view_camera = T_world_view.inverse() * T_world_camera;
  EXPECT_LE(moving_cells(), 20);
}

}  // namespace
}  // namespace holdfast
