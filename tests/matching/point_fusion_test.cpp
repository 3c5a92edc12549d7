// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/point_fusion.hpp"

#include <gtest/gtest.h>

#include "holdfast/matching/point_block.hpp"
#include "matching/grid_frame.hpp"

namespace holdfast {
namespace {

/// Three keyframes; point a is seen by the first two, point b by the third, both by feature 0.
struct TwoPoints {
  TwoPoints() {
    for (KeyFrameId& id : keyframes) id = map.add_keyframe(test::grid_frame(10));
    a = map.add_point({0, 0, 2}, 0), b = map.add_point({0, 0, 2.01}, 2);
    map.add_observation(a, keyframes[0], 0), map.add_observation(a, keyframes[1], 0);
    map.add_observation(b, keyframes[2], 0);
    map.update_point(a), map.update_point(b);
  }
  Map map;
  std::array<KeyFrameId, 3> keyframes;
  MapPointId a, b;
};

TEST(PointFusion, AFreeFeatureObservesThePoint) {
  TwoPoints world;
  EXPECT_EQ(add_or_fuse(world.map, world.a, world.keyframes[2], 4, FusionSurvivor::more_observed),
            FusionOutcome::observation_added);
  EXPECT_EQ(world.map.feature_of(world.a, world.keyframes[2]), 4);
}

TEST(PointFusion, ThePointWithMoreObservationsSurvivesOrTheSearchedOne) {
  TwoPoints first;
  EXPECT_EQ(add_or_fuse(first.map, first.b, first.keyframes[0], 0, FusionSurvivor::more_observed),
            FusionOutcome::points_fused);
  EXPECT_EQ(first.map.find_point(first.b), nullptr);
  EXPECT_EQ(first.map.point(first.a).observations.size(), 3U);
  TwoPoints second;
  EXPECT_EQ(add_or_fuse(second.map, second.b, second.keyframes[0], 0, FusionSurvivor::searched_point),
            FusionOutcome::points_fused);
  EXPECT_EQ(second.map.find_point(second.a), nullptr);
  EXPECT_EQ(second.map.point(second.b).observations.size(), 3U);
}

TEST(PointFusion, NothingHappensToAPointThatIsGoneOrSeenAlready) {
  TwoPoints world;
  EXPECT_EQ(add_or_fuse(world.map, world.a, world.keyframes[1], 3, FusionSurvivor::more_observed),
            FusionOutcome::nothing);
  world.map.remove_point(world.b);
  EXPECT_EQ(add_or_fuse(world.map, world.b, world.keyframes[1], 3, FusionSurvivor::more_observed),
            FusionOutcome::nothing);
}

TEST(PointsSeenBy, NamesEachPointOnceInOrder) {
  TwoPoints world;
  const MapPointId c = world.map.add_point({1, 0, 2}, 0);
  world.map.add_observation(c, world.keyframes[0], 5);
  const std::array<KeyFrameId, 3> order = {world.keyframes[2], world.keyframes[0], world.keyframes[1]};
  EXPECT_EQ(points_seen_by(world.map, order), (std::vector<MapPointId>{world.b, world.a, c}));
  EXPECT_TRUE(points_seen_by(world.map, {}).empty());
}

}  // namespace
}  // namespace holdfast
