// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/guided_search.hpp"

#include <gtest/gtest.h>

#include "holdfast/matching/frame_features.hpp"
#include "matching/grid_frame.hpp"

namespace holdfast {
namespace {

using matching::FeatureAssignment;
using matching::FeatureMatch;
using matching::GuidedSearchSettings;
using matching::PositionGate;
using matching::SearchWindows;
using test::flipped;
using test::grid_frame;
using test::no_column;

/// One search with buffers of its own.
std::vector<FeatureMatch> search(const Frame& frame, const SearchWindows& windows,
                                 const std::vector<Descriptor256>& points, const GuidedSearchSettings& settings = {},
                                 std::vector<std::uint8_t> usable = {}) {
  return FrameSearch().match(frame, {windows, points}, settings, usable);
}

/// A window around feature 45 of grid_frame().
SearchWindows window_at(const Frame& frame, float dx, float dy, float right_x, float radius, int lowest, int highest) {
  SearchWindows windows;
  windows.add(0, {{frame.x[45] + dx, frame.y[45] + dy, right_x}, radius, lowest, highest});
  return windows;
}

TEST(GuidedSearch, FindsTheFeatureInTheWindowAndNowhereElse) {
  const Frame frame = grid_frame(200);
  const std::vector<Descriptor256> points = {flipped(frame.features.descriptors.of_256_bits()[45], 20),
                                             frame.features.descriptors.of_256_bits()[7]};
  SearchWindows windows;
  windows.add(0, {{frame.x[45] + 3, frame.y[45] - 4, no_column}, 10, 0, 1});
  windows.add(1, {{frame.x[7] + 60, frame.y[7], no_column}, 20, 0, 1});  // looked for in the wrong place
  const std::vector<FeatureMatch> matches = search(frame, windows, points);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 45U);
  EXPECT_EQ(matches[0].source, 0U);
  EXPECT_EQ(matches[0].distance, 20);
}

TEST(GuidedSearch, RefusesDescriptorsBeyondTheLargestDistance) {
  const Frame frame = grid_frame(200);
  const std::vector<Descriptor256> points = {flipped(frame.features.descriptors.of_256_bits()[45], 60)};
  const SearchWindows windows = window_at(frame, 0, 0, no_column, 10, 0, 1);
  EXPECT_EQ(search(frame, windows, points, {.max_distance = 60}).size(), 1U);
  EXPECT_EQ(search(frame, windows, points, {.max_distance = 59}).size(), 0U);
}

TEST(GuidedSearch, RefusesOctavesBelowAndAboveThoseOfTheWindow) {
  Frame frame = grid_frame(200);
  frame.features.octave[45] = 3;
  const std::vector<Descriptor256> points = {frame.features.descriptors.of_256_bits()[45]};
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, no_column, 10, 2, 3), points).size(), 1U);
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, no_column, 10, 3, 4), points).size(), 1U);
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, no_column, 10, 4, 5), points).size(), 0U);
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, no_column, 10, 1, 2), points).size(), 0U);
}

TEST(GuidedSearch, RefusesAColumnInTheRightImageOutsideTheWindow) {
  Frame frame = grid_frame(200);
  frame.right_x[45] = 100.0F;
  const std::vector<Descriptor256> points = {frame.features.descriptors.of_256_bits()[45]};
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, 105.0F, 10, 0, 1), points).size(), 1U);
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, 120.0F, 10, 0, 1), points).size(), 0U);
  EXPECT_EQ(search(frame, window_at(frame, 0, 0, no_column, 10, 0, 1), points).size(), 1U);
}

TEST(GuidedSearch, RefusesFeaturesThatAreNotUsable) {
  const Frame frame = grid_frame(200);
  const std::vector<Descriptor256> points = {frame.features.descriptors.of_256_bits()[45]};
  const SearchWindows windows = window_at(frame, 0, 0, no_column, 10, 0, 1);
  std::vector<std::uint8_t> usable(frame.size(), 1);
  EXPECT_EQ(search(frame, windows, points, {}, usable).size(), 1U);
  usable[45] = 0;
  EXPECT_EQ(search(frame, windows, points, {}, usable).size(), 0U);
}

TEST(GuidedSearch, TheChiSquareGateIsTheEllipseOfTheFeaturesNoise) {
  Frame frame = grid_frame(200);
  const std::vector<Descriptor256> points = {frame.features.descriptors.of_256_bits()[45]};
  const GuidedSearchSettings settings{.position = PositionGate::chi_square};
  const auto found = [&](float dx, float dy, float right_x) {
    return search(frame, window_at(frame, dx, dy, right_x, 10, 0, 7), points, settings).size();
  };
  // Two residuals: sqrt(5.991) = 2.448 px at octave 0.
  EXPECT_EQ(found(2.4F, 0, no_column), 1U);
  EXPECT_EQ(found(2.5F, 0, no_column), 0U);
  EXPECT_EQ(found(1.8F, 1.8F, no_column), 0U);
  // Three: sqrt(7.815) = 2.796 px.
  frame.right_x[45] = 100.0F;
  EXPECT_EQ(found(2.5F, 0, 100.0F), 1U);
  EXPECT_EQ(found(0, 0, 102.7F), 1U);
  EXPECT_EQ(found(0, 0, 102.9F), 0U);
  EXPECT_EQ(found(1.8F, 1.8F, 101.5F), 0U);
  // A coarser octave is noisier.
  frame.features.octave[45] = 4;
  EXPECT_EQ(found(1.8F, 1.8F, 101.5F), 1U);
}

TEST(GuidedSearch, AFeatureGoesToTheNearestPointAndOfEqualOnesToTheFirst) {
  const Frame frame = grid_frame(100);
  const std::vector<Descriptor256> points = {flipped(frame.features.descriptors.of_256_bits()[10], 30),
                                             flipped(frame.features.descriptors.of_256_bits()[10], 10),
                                             flipped(frame.features.descriptors.of_256_bits()[10], 10)};
  SearchWindows windows;
  for (std::uint32_t i = 0; i < 3; ++i) windows.add(i, {{frame.x[10], frame.y[10], no_column}, 5, 0, 0});
  const std::vector<FeatureMatch> matches = search(frame, windows, points);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].source, 1U);
}

TEST(GuidedSearch, EveryPointKeepsItsFeatureWhenDuplicatesAreLookedFor) {
  const Frame frame = grid_frame(100);
  const std::vector<Descriptor256> points = {frame.features.descriptors.of_256_bits()[11],
                                             flipped(frame.features.descriptors.of_256_bits()[10], 30),
                                             flipped(frame.features.descriptors.of_256_bits()[10], 10)};
  SearchWindows windows;
  windows.add(0, {{frame.x[11], frame.y[11], no_column}, 5, 0, 0});
  for (std::uint32_t i = 1; i < 3; ++i) windows.add(i, {{frame.x[10], frame.y[10], no_column}, 5, 0, 0});
  const std::vector<FeatureMatch> matches =
      search(frame, windows, points, {.assignment = FeatureAssignment::every_point});
  ASSERT_EQ(matches.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(matches[i].source, i);  // in the order of the windows
  EXPECT_EQ(matches[1].feature, 10U);
  EXPECT_EQ(matches[2].feature, 10U);
}

TEST(GuidedSearch, OfEquallyNearFeaturesTheFirstOfTheGridIsTaken) {
  Frame frame = grid_frame(100);
  frame.features.descriptors.of_256_bits()[11] = frame.features.descriptors.of_256_bits()[10];
  SearchWindows windows;
  windows.add(0, {{frame.x[10], frame.y[10], no_column}, 40, 0, 0});
  const std::vector<FeatureMatch> matches = search(frame, windows, {frame.features.descriptors.of_256_bits()[10]});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].feature, 10U);
}

TEST(GuidedSearch, AmbiguousMatchesAreRefusedByTheRatioOnOneOctaveOnly) {
  Frame frame = grid_frame(100);
  frame.features.descriptors.of_256_bits()[11] = flipped(frame.features.descriptors.of_256_bits()[10], 4);
  const std::vector<Descriptor256> points = {flipped(frame.features.descriptors.of_256_bits()[10], 40)};
  SearchWindows windows;
  windows.add(0, {{frame.x[10], frame.y[10], no_column}, 40, 0, 1});
  EXPECT_EQ(search(frame, windows, points, {.ratio = 0.8F}).size(), 0U);
  EXPECT_EQ(search(frame, windows, points, {.ratio = 1.0F}).size(), 1U);
  frame.features.octave[11] = 1;
  EXPECT_EQ(search(frame, windows, points, {.ratio = 0.8F}).size(), 1U);
}

TEST(GuidedSearch, RotationsThatFewMatchesShareAreDropped) {
  const Frame frame = grid_frame(100);
  std::vector<float> angles(100, 0.5F);
  angles[17] = 3.0F;
  SearchWindows windows;
  for (std::uint32_t i = 0; i < 100; ++i) windows.add(i, {{frame.x[i], frame.y[i], no_column}, 5, 0, 0});
  FrameSearch search;
  const auto& matches = search.match(frame, {windows, frame.features.descriptors, angles}, {});
  EXPECT_EQ(matches.size(), 99U);
  for (const FeatureMatch& match : matches) EXPECT_NE(match.feature, 17U);
  EXPECT_EQ(search.match(frame, {windows, frame.features.descriptors}, {}).size(), 100U);
}

}  // namespace
}  // namespace holdfast
