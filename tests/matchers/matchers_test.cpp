// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>

#include "holdfast/interfaces/feature_matcher.hpp"
#include "matching/grid_frame.hpp"
#include "mutual_ratio.hpp"

namespace holdfast {
namespace {

using mutual_ratio_plugin::MutualRatioMatcher;
using test::flipped;

std::vector<std::uint32_t> all_of(const Frame& frame) {
  std::vector<std::uint32_t> all(frame.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// The frame with descriptors of which `bits` differ, and feature 7 as a twin of feature 3.
Frame seen_again(const Frame& frame, int bits) {
  Frame again = frame;
  const std::span<Descriptor256> descriptors = again.features.descriptors.of_256_bits();
  for (Descriptor256& descriptor : descriptors) descriptor = flipped(descriptor, bits);
  descriptors[7] = flipped(frame.features.descriptors.of_256_bits()[3], bits + 2);
  return again;
}

std::vector<FeatureMatch> match(const FeatureMatcher& matcher, const Frame& a, const Frame& b,
                                const MatchLimits& limits) {
  const auto in_a = all_of(a), in_b = all_of(b);
  std::vector<FeatureMatch> matches;
  matcher.match(side_of(a, in_a), side_of(b, in_b), limits, matches);
  return matches;
}

bool has(const std::vector<FeatureMatch>& matches, std::uint32_t source, std::uint32_t feature) {
  return std::any_of(matches.begin(), matches.end(),
                     [&](const FeatureMatch& match) { return match.source == source && match.feature == feature; });
}

TEST(NearestMatcher, FollowsTheLimitsOfItsCaller) {
  const Frame a = test::grid_frame(60), b = seen_again(a, 20);
  const NearestMatcher matcher;
  EXPECT_EQ(match(matcher, a, b, {.max_distance = 19.0F}).size(), 0U);
  const auto strict = match(matcher, a, b, {.max_distance = 50.0F, .ratio = 0.8F});
  EXPECT_EQ(strict.size(), 58U) << "all but the twins";
  EXPECT_FALSE(has(strict, 3, 3)) << "the twin is a rival";
  const auto without_ratio = match(matcher, a, b, {.max_distance = 50.0F, .ratio = 1.0F});
  EXPECT_TRUE(has(without_ratio, 3, 3));
  const auto no_rival = [](std::uint32_t nearest, std::uint32_t other) { return !(nearest == 3 && other == 7); };
  EXPECT_TRUE(has(match(matcher, a, b, {.max_distance = 50.0F, .ratio = 0.8F, .is_rival = no_rival}), 3, 3));
}

TEST(NearestMatcher, ASideSaysWhatItsFrameSays) {
  const Frame frame = test::grid_frame(30);
  const auto all = all_of(frame);
  const MatchSide side = side_of(frame, all);
  EXPECT_EQ(side.x.size(), 30U);
  EXPECT_EQ(side.y[25], frame.y[25]);
  EXPECT_EQ(side.octave.size(), 30U);
  EXPECT_EQ(side.angle[3], 1.0F);
  EXPECT_EQ(side.width, frame.camera->width);
  EXPECT_EQ(side.descriptors.size(), 30U);
}

TEST(MutualRatioMatcher, HasOneRuleForAllCallers) {
  const Frame a = test::grid_frame(60), b = seen_again(a, 20);
  const MutualRatioMatcher matcher(MutualRatioSettings{.ratio = 0.8});
  const auto matches = match(matcher, a, b, {.max_distance = 50.0F, .ratio = 1.0F});
  EXPECT_EQ(matches.size(), 58U);
  EXPECT_FALSE(has(matches, 3, 3)) << "its ratio holds where the caller asks for none";
  EXPECT_EQ(match(matcher, a, b, {.max_distance = 15.0F}).size(), 0U);
  const MutualRatioMatcher generous(MutualRatioSettings{.ratio = 0.8, .distance_factor = 2.0});
  EXPECT_EQ(match(generous, a, b, {.max_distance = 15.0F}).size(), 58U) << "20 bits of 2 * 15";
}

TEST(MutualRatioMatcher, RequiresTheLeadNearPredictionsToo) {
  const Frame a = test::grid_frame(60);
  Frame b = seen_again(a, 20);
  matching::SearchWindows windows;
  for (std::uint32_t i = 0; i < a.size(); ++i) windows.add(i, {{a.x[i], a.y[i], 0.0F}, 125.0F, 0, 7});
  const FrameSearch::Query points{windows, a.features.descriptors};
  std::vector<FeatureMatch> nearest, own;
  NearestMatcher().match_guided(b, points, {.max_distance = 50.0F}, {}, nearest);
  MutualRatioMatcher(MutualRatioSettings{}).match_guided(b, points, {.max_distance = 50.0F}, {}, own);
  EXPECT_TRUE(has(nearest, 3, 3));
  EXPECT_FALSE(has(own, 3, 3)) << "the twin lies within the window";
  EXPECT_TRUE(has(own, 20, 20));
}

}  // namespace
}  // namespace holdfast
