// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/did_you_mean.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

TEST(EditDistance, CountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("cuont", "count"), 1) << "a swap of neighbours is one edit";
  EXPECT_EQ(edit_distance("orb", "orb"), 0);
}

TEST(DidYouMean, NamesTheNearest) {
  const std::vector<std::string> known{"features", "filters", "loop_detector", "orb"};
  EXPECT_EQ(nearest_name("featrues", known), "features");
  EXPECT_EQ(nearest_name("Loop-Detector", known), "loop_detector");
  EXPECT_EQ(nearest_name("loop", known), "loop_detector");
  EXPECT_EQ(nearest_name("ORB", known), "orb");
  EXPECT_EQ(nearest_name("xylophone", known), std::nullopt);
}

TEST(DidYouMean, ListsTheKnownWhenNoneIsNear) {
  EXPECT_EQ(did_you_mean("obr", {"orb", "sift"}), "did you mean 'orb'?");
  EXPECT_EQ(did_you_mean("xylophone", {"orb", "sift"}), "known are orb, sift");
  EXPECT_EQ(did_you_mean("x", {"a", "b"}), "known are a, b") << "one letter resembles no other";
  EXPECT_EQ(did_you_mean("x", {}), "none is known");
}

}  // namespace
}  // namespace holdfast
