// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/map_rows.hpp"

namespace holdfast {
namespace {

/// Two rows of keyframes that share nothing; the second is submap 1.
class Submaps : public testing::Test {
 protected:
  Submaps() : first(test::build_row(map, 6)), second(test::build_row(map, 6)), number(map.new_submap()) {
    for (const KeyFrameId id : second) map.keyframe(id).submap = number;
  }
  Map map;
  std::vector<KeyFrameId> first, second;
  std::uint32_t number;
};

TEST_F(Submaps, ARemovedKeyframeBelongsToTheSubmapOfItsParent) {
  EXPECT_EQ(map.submap_of(first[2]), 0U);
  map.remove_keyframe(second[3]);
  EXPECT_EQ(map.submap_of(second[3]), number);
  EXPECT_EQ(map.keyframes_outside(0).size(), 5U);
  EXPECT_EQ(map.keyframes_in(0), 6U);
  EXPECT_EQ(map.keyframes_in(number), 5U);
}

TEST_F(Submaps, JoinedOnesHaveTheLowerNumber) {
  EXPECT_NE(map.new_submap(), number);
  map.join_submaps(number, 0);
  for (const KeyFrameId id : second) EXPECT_EQ(map.submap_of(id), 0U);
  EXPECT_TRUE(map.keyframes_outside(0).empty());
}

TEST_F(Submaps, OneIsKeptAndTheOthersLeaveNothing) {
  map.remove_keyframe(first[3]);
  const std::size_t points = map.points().size();
  map.keep_submap(number);
  EXPECT_EQ(map.keyframes().size(), second.size());
  EXPECT_LT(map.points().size(), points);
  for (const KeyFrameId id : first) EXPECT_EQ(map.submap_of(id), std::nullopt);
  for (const KeyFrameId id : second) EXPECT_EQ(map.submap_of(id), number);
  test::expect_consistent(map);
}

}  // namespace
}  // namespace holdfast
