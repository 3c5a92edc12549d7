// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/projection_search.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

/// A frame with features on a coarse grid, each with its own descriptor.
Frame grid_frame(int count) {
  Frame frame;
  Random random(11);
  frame.features.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    frame.x.push_back(20.0F + 30.0F * static_cast<float>(i % 20));
    frame.y.push_back(20.0F + 30.0F * static_cast<float>(i / 20));
    frame.features.angle[static_cast<std::size_t>(i)] = 1.0F;
    for (std::uint64_t& word : frame.features.descriptors[static_cast<std::size_t>(i)].words) word = random.next();
  }
  frame.depth.assign(frame.size(), 0.0F);
  frame.right_x.assign(frame.size(), none);
  frame.map_points.assign(frame.size(), MapPointId());
  frame.grid.build(frame.x, frame.y, 0, 0, 639, 479);
  return frame;
}

Descriptor flipped(Descriptor descriptor, int bits) {
  for (int i = 0; i < bits; ++i) descriptor.words[static_cast<std::size_t>(i) / 64] ^= std::uint64_t{1} << (i % 64);
  return descriptor;
}

TEST(ProjectionSearch, FindsTheFeatureInTheWindowAndNowhereElse) {
  const Frame frame = grid_frame(200);
  ProjectionSearch search;
  const std::vector<Descriptor> points = {flipped(frame.features.descriptors[45], 20), frame.features.descriptors[7]};
  SearchWindows windows;
  windows.add(0, frame.x[45] + 3, frame.y[45] - 4, none, 10, 0, 1);
  windows.add(1, frame.x[7] + 60, frame.y[7], none, 20, 0, 1);  // looked for in the wrong place
  const auto& matches = search.match(windows, points.data(), frame, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 45U);
  EXPECT_EQ(matches[0].source, 0U);
  EXPECT_EQ(matches[0].distance, 20);
}

TEST(ProjectionSearch, HonoursDistanceOctaveDepthAndTakenFeatures) {
  Frame frame = grid_frame(200);
  const std::vector<Descriptor> points = {flipped(frame.features.descriptors[45], 60)};
  const auto count = [&](MatchRule rule, float right_x, int lowest) {
    ProjectionSearch search;
    SearchWindows windows;
    windows.add(0, frame.x[45], frame.y[45], right_x, 10, lowest, lowest + 1);
    return search.match(windows, points.data(), frame, rule).size();
  };
  EXPECT_EQ(count({.maximum_distance = 60}, none, 0), 1U);
  EXPECT_EQ(count({.maximum_distance = 59}, none, 0), 0U);
  EXPECT_EQ(count({}, none, 1), 0U);  // the feature lies on octave 0
  frame.right_x[45] = 100.0F;
  EXPECT_EQ(count({}, 105.0F, 0), 1U);
  EXPECT_EQ(count({}, 120.0F, 0), 0U);
  frame.map_points[45] = MapPointId{3, 0};
  EXPECT_EQ(count({}, none, 0), 0U);
}

TEST(ProjectionSearch, AFeatureGoesToTheNearestPoint) {
  const Frame frame = grid_frame(100);
  const std::vector<Descriptor> points = {flipped(frame.features.descriptors[10], 30),
                                          flipped(frame.features.descriptors[10], 10)};
  SearchWindows windows;
  for (std::uint32_t i = 0; i < 2; ++i) windows.add(i, frame.x[10], frame.y[10], none, 5, 0, 0);
  ProjectionSearch search;
  const auto& matches = search.match(windows, points.data(), frame, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].source, 1U);
}

TEST(ProjectionSearch, AmbiguousMatchesAreRefusedByTheRatio) {
  Frame frame = grid_frame(100);
  frame.features.descriptors[11] = flipped(frame.features.descriptors[10], 4);
  const std::vector<Descriptor> points = {flipped(frame.features.descriptors[10], 40)};
  SearchWindows windows;
  windows.add(0, frame.x[10], frame.y[10], none, 40, 0, 0);
  ProjectionSearch search;
  EXPECT_EQ(search.match(windows, points.data(), frame, {.ratio = 0.8F}).size(), 0U);
  EXPECT_EQ(search.match(windows, points.data(), frame, {.ratio = 1.0F}).size(), 1U);
}

TEST(ProjectionSearch, RotationsThatStandAloneAreDropped) {
  const Frame frame = grid_frame(100);
  std::vector<float> angles(100, 0.5F);
  angles[17] = 3.0F;
  SearchWindows windows;
  for (std::uint32_t i = 0; i < 100; ++i) windows.add(i, frame.x[i], frame.y[i], none, 5, 0, 0);
  ProjectionSearch search;
  const auto& matches = search.match(windows, frame.features.descriptors.data(), frame, {.angles = angles.data()});
  EXPECT_EQ(matches.size(), 99U);
  for (const ProjectionMatch& match : matches) EXPECT_NE(match.feature, 17U);
}

}  // namespace
}  // namespace holdfast
