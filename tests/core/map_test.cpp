// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/map.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "core/map_rows.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using test::build_row, test::expect_consistent, test::frame_with;

TEST(Map, LinksStayConsistentWhileKeyframesAndPointsComeAndGo) {
  Map map;
  std::vector<KeyFrameId> ids = build_row(map, 12);
  expect_consistent(map);
  Random random(3);
  for (const int k : {4, 7, 5, 11}) {
    map.remove_keyframe(ids[static_cast<std::size_t>(k)]);
    expect_consistent(map);
  }
  for (int i = 0; i < 40; ++i) {
    const auto points = map.points().ids();
    const MapPointId a = points[random.below(static_cast<std::uint32_t>(points.size()))];
    const MapPointId b = points[random.below(static_cast<std::uint32_t>(points.size()))];
    if (i % 2 == 0)
      map.remove_point(a);
    else
      map.fuse_points(a, b);
    expect_consistent(map);
  }
}

TEST(Map, RemovedKeyframeKeepsItsPoseThroughItsParent) {
  Map map;
  const std::vector<KeyFrameId> ids = build_row(map, 6);
  const Eigen::Isometry3d before = map.pose_of(ids[3]);
  map.remove_keyframe(ids[3]);
  EXPECT_TRUE(map.pose_of(ids[3]).isApprox(before, 1e-12));
  // When everything moves as one, the removed keyframe moves along.
  const Eigen::Isometry3d shift(Eigen::Translation3d(1, 2, 3));
  for (const KeyFrameId id : map.keyframes().ids())
    map.keyframe(id).frame.T_camera_world = map.keyframe(id).frame.T_camera_world * shift;
  EXPECT_TRUE(map.pose_of(ids[3]).isApprox(before * shift, 1e-12));
}

TEST(Map, ARemovedKeyframeFollowsTheScaleOfItsParent) {
  Map map;
  const std::vector<KeyFrameId> ids = build_row(map, 6);
  // One keyframe was scaled before it left the map, its parent only later.
  map.keyframe(ids[4]).scale = 1.5;
  const KeyFrameId parent = map.keyframe(ids[4]).parent;
  ASSERT_TRUE(parent.valid());
  const Eigen::Isometry3d before = map.pose_of(ids[4]) * map.pose_of(parent).inverse();
  map.remove_keyframe(ids[4]);
  EXPECT_EQ(map.scale_of(ids[4]), 1.5);
  map.keyframe(parent).scale *= 2.0;
  EXPECT_DOUBLE_EQ(map.scale_of(ids[4]), 3.0);
  EXPECT_EQ(map.scale_of(ids[0]), parent == ids[0] ? 2.0 : 1.0);
  // Its way from the parent has grown with the parent's surroundings, and its direction has not changed.
  const Eigen::Isometry3d now = map.pose_of(ids[4]) * map.pose_of(parent).inverse();
  EXPECT_GT(before.translation().norm(), 0.05);
  EXPECT_TRUE(now.translation().isApprox(2.0 * before.translation(), 1e-12));
  EXPECT_TRUE(now.linear().isApprox(before.linear(), 1e-12));
  // A chain: the parent leaves as well, and its own parent is scaled.
  if (!map.keyframe(parent).parent.valid()) return;
  const KeyFrameId grandparent = map.keyframe(parent).parent;
  map.remove_keyframe(parent);
  EXPECT_DOUBLE_EQ(map.scale_of(ids[4]), 3.0);
  map.keyframe(grandparent).scale *= 0.5;
  EXPECT_DOUBLE_EQ(map.scale_of(parent), 1.0);
  EXPECT_DOUBLE_EQ(map.scale_of(ids[4]), 1.5);
  const Eigen::Isometry3d end = map.pose_of(ids[4]) * map.pose_of(parent).inverse();
  EXPECT_TRUE(end.translation().isApprox(before.translation(), 1e-12));
}

TEST(Map, FirstKeyframeCannotBeRemoved) {
  Map map;
  const std::vector<KeyFrameId> ids = build_row(map, 3);
  EXPECT_THROW(map.remove_keyframe(ids[0]), CheckError);
}

TEST(Map, IdsOfRemovedPointsNameNothing) {
  Map map;
  build_row(map, 2);
  const MapPointId id = map.points().ids().front();
  map.remove_point(id);
  EXPECT_EQ(map.find_point(id), nullptr);
  EXPECT_THROW(map.point(id), CheckError);
  const MapPointId next = map.add_point(Eigen::Vector3d::Zero(), 0);
  EXPECT_EQ(next.slot, id.slot);
  EXPECT_NE(next, id);
}

TEST(Map, KeyframeForgetsPointsThatAreGone) {
  Map map;
  build_row(map, 2);
  const MapPointId gone = map.points().ids().front();
  Frame frame = frame_with(10, 9.0, {0, 0, 0});
  frame.map_points[3] = gone;
  map.remove_point(gone);
  const KeyFrameId id = map.add_keyframe(frame);
  EXPECT_FALSE(map.keyframe(id).frame.map_points[3].valid());
}

TEST(Map, DistanceRangeFollowsTheOctaveOfTheReference) {
  Map map;
  Frame frame = frame_with(2, 1.0, {0, 0, 0});
  frame.features.octave = {0, 3};
  const KeyFrameId id = map.add_keyframe(frame);
  for (std::uint32_t f = 0; f < 2; ++f) {
    const MapPointId point = map.add_point({0, 0, 2}, 0);
    map.add_observation(point, id, f);
    map.update_point(point);
    EXPECT_NEAR(map.point(point).maximum_distance, 2.0 * std::pow(1.2, f == 0 ? 0 : 3), 1e-4);
    EXPECT_NEAR(map.point(point).minimum_distance, map.point(point).maximum_distance / std::pow(1.2, 7), 1e-4);
    EXPECT_TRUE(map.point(point).viewing_direction.isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  }
}

TEST(Map, TheDescriptorWithTheLeastMedianDistanceRepresentsAPoint) {
  Map map;
  const MapPointId point = map.add_point({0, 0, 2}, 0);
  // Numbers of bits that are set, from the lowest: distances are differences of these numbers.
  const std::vector<int> bits = {40, 0, 9, 10, 12};
  const std::vector<std::size_t> expected = {0, 0, 1, 2, 3};  // observation, when so many were made and one more
  for (std::size_t k = 0; k < bits.size(); ++k) {
    Frame frame = frame_with(1, 1.0, {0, 0, 0});
    frame.features.descriptors.row(0)->words = {(std::uint64_t{1} << bits[k]) - 1, 0, 0, 0};
    map.add_observation(point, map.add_keyframe(frame), 0);
    map.update_point(point);
    EXPECT_EQ(std::popcount(map.point(point).descriptor.row(0)->words[0]), bits[expected[k]]) << k;
    EXPECT_EQ(map.point(point).descriptor.size(), 1U);
  }
}

TEST(Map, FusedPointsKeepTheLimitOfEvidence) {
  for (const float sign : {1.0F, -1.0F}) {
    Map map;
    build_row(map, 3);
    map.set_evidence_limit(3.0F);
    const auto points = map.points().ids();
    map.point(points[0]).static_log_odds = sign * 2.0F;
    map.point(points[1]).static_log_odds = sign * 0.5F;
    map.point(points[2]).static_log_odds = sign * 2.5F;
    map.fuse_points(points[0], points[1]);
    EXPECT_EQ(map.point(points[1]).static_log_odds, sign * 2.5F);
    map.fuse_points(points[2], points[1]);
    EXPECT_EQ(map.point(points[1]).static_log_odds, sign * 3.0F);
  }
}

}  // namespace
}  // namespace holdfast
