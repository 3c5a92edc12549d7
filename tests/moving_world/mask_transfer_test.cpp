// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/mask_transfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "moving_world/overlap.hpp"
#include "support/box_world.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::BoxWorld;
using test::overlap;

/// What a world shows before and after, with true labels.
struct Sight {
  Sight(const BoxWorld& world, const Isometry3d& pose) : T_world_camera(pose) { view = world.view(pose, &truth); }
  CellMask exact() const {
    return {.labels = truth,
            .confidence = std::vector<std::uint8_t>(truth.size(), 255),
            .moving = std::vector<std::uint8_t>(truth.size(), 0)};
  }
  Isometry3d T_world_camera;
  CoarseView view;
  std::vector<std::uint8_t> truth;
};

/// Points on the front of a box, every `spacing` metres, that move along with it.
FollowedPairs follow(const BoxWorld::Box& from, const BoxWorld::Box& to, const Sight& before, const Sight& after,
                     const Camera& camera, double spacing = 0.06) {
  FollowedPairs pairs;
  const auto project = [&](const Vector3d& point, const Sight& sight, std::vector<float>& x, std::vector<float>& y,
                           std::vector<float>& depth) {
    const Vector3d in_camera = sight.T_world_camera.inverse() * point;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    x.push_back(static_cast<float>(pixel.x())), y.push_back(static_cast<float>(pixel.y()));
    depth.push_back(static_cast<float>(in_camera.z()));
  };
  const Vector3d motion = to.minimum - from.minimum;
  for (double y = from.minimum.y() + 0.03; y < from.maximum.y(); y += spacing)
    for (double x = from.minimum.x() + 0.03; x < from.maximum.x(); x += spacing) {
      const Vector3d point(x, y, from.minimum.z());
      project(point, before, pairs.from_x, pairs.from_y, pairs.from_depth);
      project(point + motion, after, pairs.to_x, pairs.to_y, pairs.to_depth);
    }
  return pairs;
}

std::vector<std::uint8_t> transferred(const BoxWorld& world, const Sight& before, const Sight& after,
                                      const FollowedPairs& pairs) {
  MaskTransfer transfer(world.camera);
  CellMask to;
  transfer.transfer(before.view, before.exact(), after.view, after.T_world_camera.inverse() * before.T_world_camera,
                    pairs, to);
  EXPECT_EQ(to.labels.size(), after.truth.size());
  EXPECT_EQ(to.confidence.size(), after.truth.size());
  EXPECT_EQ(to.moving.size(), after.truth.size());
  return to.labels;
}

const Isometry3d at_origin = Isometry3d::Identity();
Isometry3d turned(double degrees, const Vector3d& to = Vector3d::Zero()) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(degrees * 0.017453292519943295, Vector3d::UnitY()).toRotationMatrix();
  T.translation() = to;
  return T;
}
BoxWorld::Box box_at(double x, double z = 1.5) { return BoxWorld::box({x, 0, z}, {0.15, 0.2, 0.05}); }

TEST(MaskTransfer, FollowedPointsTakeTheMaskAlong) {
  // Farther than its own width, and away from the camera, too: nothing of it is where any of it was.
  for (const double z : {1.5, 1.7}) {
    const BoxWorld::Box from = box_at(-0.3), to = box_at(0.25, z);
    BoxWorld world;
    world.boxes = {from};
    const Sight before(world, at_origin);
    world.boxes = {to};
    const Sight after(world, at_origin);
    ASSERT_EQ(overlap(before.truth, after.truth), 0.0);
    EXPECT_GE(overlap(transferred(world, before, after, follow(from, to, before, after, world.camera)), after.truth),
              0.9);
    EXPECT_EQ(overlap(transferred(world, before, after, {}), after.truth), 0.0);
  }
}

/// As transferred(), of one camera: without depth, and with points of which the depth is not known.
std::vector<std::uint8_t> transferred_without_depth(const BoxWorld& world, Sight before, Sight after,
                                                    FollowedPairs pairs) {
  std::fill(before.view.depth.begin(), before.view.depth.end(), 0.0F);
  std::fill(after.view.depth.begin(), after.view.depth.end(), 0.0F);
  std::fill(pairs.from_depth.begin(), pairs.from_depth.end(), 0.0F);
  std::fill(pairs.to_depth.begin(), pairs.to_depth.end(), 0.0F);
  MaskTransfer transfer(world.camera, false);
  CellMask to;
  transfer.transfer(before.view, before.exact(), after.view, after.T_world_camera.inverse() * before.T_world_camera,
                    pairs, to);
  return to.labels;
}

TEST(MaskTransfer, WithoutDepthPointsAloneTakeTheMaskAlong) {
  const BoxWorld::Box from = box_at(-0.3), to = box_at(0.1);
  BoxWorld world;
  world.boxes = {from};
  const Sight before(world, at_origin);
  world.boxes = {to};
  const Sight after(world, at_origin);
  const FollowedPairs pairs = follow(from, to, before, after, world.camera);
  EXPECT_GE(overlap(transferred_without_depth(world, before, after, pairs), after.truth), 0.9);
  // An object without any texture turns with the camera, and keeps its size.
  const Sight turned_away(world, turned(10));
  EXPECT_GE(overlap(transferred_without_depth(world, after, turned_away, {}), turned_away.truth), 0.85);
}

TEST(MaskTransfer, WithoutDepthWhatComesOverTheBorderOfTheImageBelongsToItsObject) {
  const BoxWorld::Box from = box_at(-0.88), to = box_at(-0.78);
  BoxWorld world;
  world.boxes = {from};
  const Sight before(world, at_origin);
  world.boxes = {to};
  const Sight after(world, at_origin);
  const auto area = [](const Sight& sight) { return std::count(sight.truth.begin(), sight.truth.end(), 1); };
  ASSERT_GT(area(before), 100);
  ASSERT_GT(area(after), area(before) * 13 / 10);
  FollowedPairs pairs;
  const FollowedPairs all = follow(from, to, before, after, world.camera);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.from_x[i] < 0.0F) continue;  // not in the image yet
    pairs.from_x.push_back(all.from_x[i]), pairs.from_y.push_back(all.from_y[i]);
    pairs.to_x.push_back(all.to_x[i]), pairs.to_y.push_back(all.to_y[i]);
    pairs.from_depth.push_back(0.0F), pairs.to_depth.push_back(0.0F);
  }
  EXPECT_GE(overlap(transferred_without_depth(world, before, after, pairs), after.truth), 0.9);
}

TEST(MaskTransfer, WhatStandsStillStaysWhereTheCameraSeesIt) {
  BoxWorld world;
  world.boxes = {box_at(0.0)};
  const Sight before(world, at_origin);
  for (const Isometry3d& T_world_camera : {turned(15), turned(-12, {0.1, -0.05, 0.2}), turned(0, {0.3, 0.1, -0.3})}) {
    const Sight after(world, T_world_camera);
    EXPECT_LE(overlap(before.truth, after.truth), 0.35);
    EXPECT_GE(overlap(transferred(world, before, after, {}), after.truth), 0.93);
  }
}

TEST(MaskTransfer, EachObjectKeepsItsLabelAndQuality) {
  BoxWorld world;
  world.boxes = {box_at(-0.4), BoxWorld::box({0.4, 0, 2.0}, {0.15, 0.2, 0.05}, 7)};
  const Sight before(world, at_origin), after(world, turned(3));
  CellMask from = before.exact(), to;
  for (std::size_t i = 0; i < from.labels.size(); ++i) {
    if (from.labels[i] == 7) from.confidence[i] = 100, from.moving[i] = 1;
  }
  MaskTransfer transfer(world.camera);
  transfer.transfer(before.view, from, after.view, after.T_world_camera.inverse(), {}, to);
  EXPECT_GE(overlap(to.labels, after.truth, 1), 0.9);
  EXPECT_GE(overlap(to.labels, after.truth, 7), 0.9);
  for (std::size_t i = 0; i < to.labels.size(); ++i) {
    if (to.labels[i] == 0) continue;
    EXPECT_EQ(to.moving[i], to.labels[i] == 7 ? 1 : 0);
    EXPECT_LE(to.confidence[i], to.labels[i] == 7 ? 100 : 255);
    EXPECT_GE(to.confidence[i], to.labels[i] == 7 ? 70 : 180);  // what was grown is less certain
  }
}

TEST(MaskTransfer, WhatAnObjectUncoversIsBackground) {
  // A wall close behind, so that only a little depth tells it from the box.
  const BoxWorld::Box from = box_at(-0.1), to = box_at(0.1);
  BoxWorld world;
  world.wall_z = 1.7;
  world.boxes = {from};
  const Sight before(world, at_origin);
  world.boxes = {to};
  const Sight after(world, at_origin);
  const std::vector<std::uint8_t> labels =
      transferred(world, before, after, follow(from, to, before, after, world.camera));
  int uncovered = 0, labelled = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (before.truth[i] == 0 || after.truth[i] != 0) continue;
    ++uncovered;
    labelled += labels[i] != 0 ? 1 : 0;
  }
  ASSERT_GE(uncovered, 300);
  EXPECT_EQ(labelled, 0);
  EXPECT_GE(overlap(labels, after.truth), 0.9);
}

TEST(MaskTransfer, DoesNotFlowOverWhatItUncoversThoughDepthGoesOn) {
  // A slanting surface comes out behind the object and touches it.
  const CoarseGrid grid = CoarseSampler(Camera()).grid();
  const auto view_with_object = [&](int from_column, std::vector<std::uint8_t>& labels) {
    CoarseView view;
    view.grid = grid;
    labels.clear();
    for (int cell = 0; cell < grid.size(); ++cell) {
      const int column = cell % grid.columns;
      const bool object = column >= from_column && column < from_column + 20;
      const float behind = column < 60 ? 1.52F + 0.02F * static_cast<float>(59 - column) : 3.0F;
      view.depth.push_back(object ? 1.5F : behind);
      labels.push_back(object ? 1 : 0);
    }
    return view;
  };
  CellMask from, to;
  std::vector<std::uint8_t> truth;
  const CoarseView before = view_with_object(40, from.labels), after = view_with_object(60, truth);
  from.confidence.assign(truth.size(), 255);
  from.moving.assign(truth.size(), 0);
  FollowedPairs pairs;
  for (float y = 20; y < 460; y += 40) {
    pairs.from_x.push_back(200), pairs.from_y.push_back(y), pairs.from_depth.push_back(1.5F);
    pairs.to_x.push_back(280), pairs.to_y.push_back(y), pairs.to_depth.push_back(1.5F);
  }
  MaskTransfer transfer{Camera()};
  transfer.transfer(before, from, after, Isometry3d::Identity(), pairs, to);
  for (int cell = 0; cell < grid.size(); ++cell) {
    const int column = cell % grid.columns;
    if (column >= 60 && column < 80) {
      EXPECT_EQ(to.labels[static_cast<std::size_t>(cell)], 1) << column;
    } else if (column < 55) {
      EXPECT_EQ(to.labels[static_cast<std::size_t>(cell)], 0) << column;
    }
  }
}

TEST(MaskTransfer, WhatComesBeforeAnObjectIsNotPartOfIt) {
  const BoxWorld::Box from = box_at(-0.3), to = box_at(0.3);
  BoxWorld world;
  world.boxes = {from};
  const Sight before(world, at_origin);
  world.boxes = {to, BoxWorld::box({0.2, 0, 1.0}, {0.1, 0.05, 0.02}, 0)};
  const Sight after(world, at_origin);
  EXPECT_GE(overlap(transferred(world, before, after, follow(from, to, before, after, world.camera)), after.truth),
            0.93);
}

TEST(MaskTransfer, GrowsOverAnArmThatReachesIntoFreeSpace) {
  BoxWorld world;
  world.boxes = {box_at(0.0)};
  const Sight before(world, at_origin);
  world.boxes.push_back(BoxWorld::box({0.35, 0, 1.5}, {0.2, 0.04, 0.05}));  // begins where the box ends
  const Sight after(world, at_origin);
  ASSERT_LE(overlap(before.truth, after.truth), 0.9);
  EXPECT_GE(overlap(transferred(world, before, after, {}), after.truth), 0.97);
}

TEST(MaskTransfer, DoesNotGrowOverAGapInDepth) {
  BoxWorld world;
  world.boxes = {box_at(0.0)};
  const Sight before(world, at_origin);
  world.boxes.push_back(BoxWorld::box({0.3, 0, 1.9}, {0.3, 0.1, 0.05}));  // another thing, farther off
  const Sight after(world, at_origin);
  std::vector<std::uint8_t> only_first = after.truth;
  for (std::size_t i = 0; i < only_first.size(); ++i)
    if (after.view.depth[i] > 1.6F) only_first[i] = 0;
  EXPECT_GE(overlap(transferred(world, before, after, {}), only_first), 0.97);
}

TEST(MaskTransfer, WhatComesIntoViewBelongsToItsObjectAndTheWallDoesNot) {
  // The box reaches over the left border of the image; the camera turns towards it.
  BoxWorld world;
  world.boxes = {BoxWorld::box({-0.95, 0, 1.5}, {0.2, 0.25, 0.05})};
  const Sight before(world, at_origin), after(world, turned(-5));
  const auto size = [](const Sight& sight) { return std::count(sight.truth.begin(), sight.truth.end(), 1); };
  ASSERT_GE(size(before), 100);
  ASSERT_GE(size(after), size(before) * 13 / 10);
  EXPECT_GE(overlap(transferred(world, before, after, {}), after.truth), 0.93);
}

TEST(MaskTransfer, TheFloorUnderAnObjectIsNotEaten) {
  // Depth goes on without a gap from the box to the floor that it stands on.
  BoxWorld world;
  world.wall_z = 5.0;
  world.floor_y = 0.8;
  const auto standing = [](double x) { return BoxWorld::box({x, 0.3, 2.6}, {0.3, 0.5, 0.1}); };
  world.boxes = {standing(0.0)};
  const Sight before(world, at_origin);
  for (const double x : {0.0, 0.1}) {
    world.boxes = {standing(x)};
    for (const Isometry3d& T_world_camera : {at_origin, turned(2, {0.02, 0.0, 0.05})}) {
      const Sight after(world, T_world_camera);
      const std::vector<std::uint8_t> labels =
          transferred(world, before, after, follow(standing(0.0), standing(x), before, after, world.camera));
      int floor = 0, eaten = 0;
      for (std::size_t i = 0; i < labels.size(); ++i) {
        const int column = static_cast<int>(i) % after.view.grid.columns;
        const int row = static_cast<int>(i) / after.view.grid.columns;
        if (!world.look(T_world_camera, after.view.grid.x_of(column), after.view.grid.y_of(row)).floor) continue;
        ++floor;
        eaten += labels[i] != 0 ? 1 : 0;
      }
      ASSERT_GE(floor, 2000);
      EXPECT_LE(eaten, floor / 100) << x;
      EXPECT_GE(overlap(labels, after.truth), 0.9) << x;
    }
  }
}

TEST(MaskTransfer, WhatIsTooNearForDepthKeepsItsLabelAndOtherHolesGetNone) {
  BoxWorld world;
  world.boxes = {BoxWorld::box({0.1, 0, 0.6}, {0.2, 0.2, 0.1}), BoxWorld::box({-0.6, 0, 2.0}, {0.2, 0.2, 0.1}, 0)};
  const auto without_depth = [](Sight sight) {
    for (std::size_t i = 0; i < sight.view.depth.size(); ++i)
      if (sight.view.depth[i] < 0.55F || (sight.truth[i] == 0 && sight.view.depth[i] < 2.5F))
        sight.view.depth[i] = 0.0F;
    return sight;
  };
  const Sight before = without_depth(Sight(world, at_origin)), after = without_depth(Sight(world, turned(6)));
  ASSERT_LE(overlap(before.truth, after.truth), 0.75);
  const std::vector<std::uint8_t> labels = transferred(world, before, after, {});
  EXPECT_GE(overlap(labels, after.truth), 0.85);  // all but its border
  for (std::size_t i = 0; i < labels.size(); ++i) EXPECT_LE(labels[i], after.truth[i]) << i;
}

TEST(MaskTransfer, HolesInTheDepthOfAnObjectAreFilled) {
  BoxWorld world;
  world.boxes = {box_at(0.0)};
  const Sight before(world, at_origin);
  Sight after(world, at_origin);
  int holes = 0;
  const int columns = after.view.grid.columns;
  for (int row = 50; row < 70; row += 3)
    for (int column = 70; column < 90; column += 3) {
      const std::size_t cell = static_cast<std::size_t>(row * columns + column);
      if (after.truth[cell] == 0) continue;
      after.view.depth[cell] = 0.0F;
      ++holes;
    }
  ASSERT_GE(holes, 20);
  EXPECT_GE(overlap(transferred(world, before, after, {}), after.truth), 0.99);
}

}  // namespace
}  // namespace holdfast
