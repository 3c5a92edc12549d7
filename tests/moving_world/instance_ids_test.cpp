// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/instance_ids.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

using Eigen::Isometry3d;

/// Things of 6 x 6 cells before a wall, seen by a camera that stands still.
class InstanceIdsTest : public testing::Test {
 protected:
  struct Thing {
    int column = 0;
    float depth = 2.0F;
    std::uint8_t label = 1;
  };

  InstanceIdsTest() { view.grid = CoarseSampler(camera).grid(); }

  /// The mask of the things, numbered in their order; sets the depth. Nearer ones hide others.
  CellMask look(const std::vector<Thing>& things) {
    const auto size = static_cast<std::size_t>(view.grid.size());
    view.depth.assign(size, 4.0F);
    CellMask mask;
    mask.assign(size, CellMask::background, 255);
    mask.instances.assign(size, 0);
    for (std::size_t k = 0; k < things.size(); ++k)
      for (int row = 30; row < 36; ++row)
        for (int column = things[k].column; column < things[k].column + 6; ++column) {
          const auto cell = static_cast<std::size_t>(row * view.grid.columns + column);
          if (view.depth[cell] < things[k].depth) continue;
          view.depth[cell] = things[k].depth;
          mask.labels[cell] = things[k].label;
          mask.instances[cell] = static_cast<std::uint16_t>(k + 1);
        }
    return mask;
  }
  /// Ids of the things, which were not carried to another frame; without what was there before, by position alone.
  std::vector<std::uint16_t> see(const std::vector<Thing>& things, double timestamp, bool has_pose = true) {
    const CellMask mask = look(things);
    const auto pose = has_pose ? std::optional(Isometry3d::Identity()) : std::nullopt;
    std::vector<std::uint16_t> result = ids.assign({camera, view, mask, pose, timestamp}, mask, held);
    held = mask;
    for (std::uint16_t& instance : held.instances) instance = result[instance];
    return {result.begin() + 1, result.end()};
  }

  using Ids = std::vector<std::uint16_t>;
  Camera camera;
  CoarseView view;
  CellMask held;
  InstanceIds ids;
};

TEST_F(InstanceIdsTest, TheOrderInTheSegmentationDoesNotMatter) {
  EXPECT_EQ(see({{20}, {60}}, 0.0), (Ids{1, 2}));
  EXPECT_EQ(see({{61}, {21}}, 0.3), (Ids{2, 1}));
  EXPECT_EQ(see({{62}, {22}, {100}}, 0.6), (Ids{2, 1, 3}));
}

TEST_F(InstanceIdsTest, ThePersonBehindIsTheSameAfterTheOcclusion) {
  // One stands at 1.5 m, the other passes behind at 2.5 m.
  for (int i = 0; i < 4; ++i) EXPECT_EQ(see({{60, 1.5F}, {40 + 4 * i, 2.5F}}, 0.25 * i), (Ids{1, 2})) << i;
  EXPECT_EQ(see({{60, 1.5F}}, 1.25), (Ids{1})) << "hidden";
  EXPECT_EQ(see({{60, 1.5F}}, 1.5), (Ids{1}));
  for (int i = 7; i < 10; ++i) EXPECT_EQ(see({{40 + 4 * i, 2.5F}, {60, 1.5F}}, 0.25 * i), (Ids{2, 1})) << i;
}

TEST_F(InstanceIdsTest, ClassesAreNotMixedAndLongAbsenceIsForgotten) {
  EXPECT_EQ(see({{20, 2.0F, 1}}, 0.0), (Ids{1}));
  EXPECT_EQ(see({{20, 2.0F, 2}}, 0.3), (Ids{2}));
  EXPECT_EQ(see({{20, 2.0F, 1}}, 0.6), (Ids{1}));
  EXPECT_EQ(see({{20, 2.0F, 1}}, 5.0), (Ids{1})) << "its mask is still there";
  held = {};
  EXPECT_EQ(see({{20, 2.0F, 1}}, 9.5), (Ids{3}));
}

TEST_F(InstanceIdsTest, WithoutDepthOrPosesTheImageDecides) {
  EXPECT_EQ(see({{20}, {60}}, 0.0, false), (Ids{1, 2}));
  held = {};
  EXPECT_EQ(see({{61}, {22}}, 0.3, false), (Ids{2, 1}));
  held = {};
  EXPECT_EQ(see({{110}}, 0.6, false), (Ids{3})) << "far from both";
}

}  // namespace
}  // namespace holdfast
