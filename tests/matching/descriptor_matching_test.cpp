// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/descriptor_matching.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "holdfast/matching/descriptors.hpp"
#include "matching/grid_frame.hpp"

namespace holdfast {
namespace {

using matching::DescriptorMatchingSettings;
using matching::FeatureMatch;
using test::flipped;
using Matcher = matching::DescriptorMatcher<DescriptorView>;

std::vector<Descriptor256> random_descriptors(std::size_t count) {
  Random random(1);
  std::vector<Descriptor256> descriptors(count);
  for (Descriptor256& descriptor : descriptors)
    for (std::uint64_t& word : descriptor.words) word = random.next() & random.next();
  return descriptors;
}

std::vector<std::uint32_t> indices_of(const std::vector<Descriptor256>& descriptors) {
  std::vector<std::uint32_t> indices(descriptors.size());
  std::iota(indices.begin(), indices.end(), 0U);
  return indices;
}

std::vector<FeatureMatch> match(const std::vector<Descriptor256>& queries, const std::vector<Descriptor256>& references,
                                const DescriptorMatchingSettings& settings) {
  return Matcher().match({queries, indices_of(queries)}, {references, indices_of(references)}, settings);
}

TEST(NearestTwo, AgreesWithSortingAndPrefersTheFirstOfEquals) {
  std::vector<Descriptor256> descriptors = random_descriptors(200);
  descriptors[120] = descriptors[30];
  std::vector<float> buffer;
  for (std::uint32_t query = 0; query < descriptors.size(); ++query) {
    std::vector<std::uint32_t> candidates = indices_of(descriptors);
    candidates.erase(candidates.begin() + query);
    const auto nearest = matching::nearest_two(DescriptorView(descriptors), query, DescriptorView(descriptors),
                                               std::span<const std::uint32_t>(candidates), buffer);
    std::stable_sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
      return hamming_distance(descriptors[query], descriptors[a]) <
             hamming_distance(descriptors[query], descriptors[b]);
    });
    EXPECT_EQ(nearest.best, candidates[0]);
    EXPECT_EQ(nearest.second, candidates[1]);
    EXPECT_EQ(nearest.best_distance, 1.0F * hamming_distance(descriptors[query], descriptors[candidates[0]]));
    EXPECT_EQ(nearest.second_distance, 1.0F * hamming_distance(descriptors[query], descriptors[candidates[1]]));
  }
}

TEST(NearestTwo, OfNothingIsNothing) {
  const auto nearest = matching::nearest_two<float>({}, nullptr);
  EXPECT_FALSE(nearest.has_best());
  EXPECT_FALSE(nearest.has_second());
}

TEST(DescriptorMatching, FindsEachPartnerOnce) {
  const std::vector<Descriptor256> references = random_descriptors(80);
  std::vector<Descriptor256> queries;
  for (std::size_t i = 0; i < 80; ++i) queries.push_back(flipped(references[79 - i], static_cast<int>(i % 7)));
  for (const bool mutual : {false, true}) {
    const std::vector<FeatureMatch> matches = match(queries, references, {.mutual = mutual});
    ASSERT_EQ(matches.size(), 80U);
    for (std::uint32_t i = 0; i < 80; ++i) {
      EXPECT_EQ(matches[i].feature, i);  // ordered by reference
      EXPECT_EQ(matches[i].source, 79 - i);
      EXPECT_EQ(matches[i].distance, (79 - i) % 7);
    }
  }
}

TEST(DescriptorMatching, RefusesDescriptorsBeyondTheLargestDistance) {
  const std::vector<Descriptor256> references = random_descriptors(20);
  const std::vector<Descriptor256> queries = {flipped(references[3], 30)};
  EXPECT_EQ(match(queries, references, {.max_distance = 30, .ratio = 1}).size(), 1U);
  EXPECT_EQ(match(queries, references, {.max_distance = 29, .ratio = 1}).size(), 0U);
}

TEST(DescriptorMatching, RefusesMatchesWithARivalUnlessItShowsTheSame) {
  std::vector<Descriptor256> references = random_descriptors(20);
  references[8] = flipped(references[3], 4);
  const std::vector<Descriptor256> queries = {flipped(references[3], 20)};  // 16 away from reference 8, 20 from 3
  EXPECT_EQ(match(queries, references, {.ratio = 0.8F}).size(), 1U);        // 16 = 0.8 * 20 is just clear enough
  EXPECT_EQ(match(queries, references, {.ratio = 0.79F}).size(), 0U);
  const std::vector<std::uint32_t> one = {0}, all = indices_of(references);
  const auto is_elsewhere = [](std::uint32_t nearest, std::uint32_t other) {
    EXPECT_EQ(nearest, 8U);
    return other != 3;
  };
  Matcher matcher;
  EXPECT_EQ(matcher.match({queries, one}, {references, all}, {.ratio = 0.79F}, is_elsewhere).size(), 1U);
}

TEST(DescriptorMatching, AReferenceKeepsTheNearestQueryAndOfEqualOnesTheFirst) {
  const std::vector<Descriptor256> references = random_descriptors(20);
  const std::vector<Descriptor256> queries = {flipped(references[3], 20), flipped(references[3], 8),
                                              flipped(references[3], 8)};
  const std::vector<FeatureMatch> matches = match(queries, references, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].source, 1U);
}

TEST(DescriptorMatching, MutualMatchesAskTheReferenceToo) {
  const std::vector<Descriptor256> references = random_descriptors(20);
  // The nearest query of reference 3 has a rival and is refused; only a mutual match then refuses the second query,
  // too.
  std::vector<Descriptor256> doubled = references;
  doubled[8] = flipped(references[3], 8);
  Descriptor256 between = flipped(references[3], 4), lonely = references[3];
  for (int bit = 100; bit < 106; ++bit) lonely.words[1] ^= std::uint64_t{1} << (bit - 64);
  const std::vector<Descriptor256> queries = {between, lonely};  // 4 and 6 away from reference 3
  const DescriptorMatchingSettings one_way{.ratio = 0.8F}, both_ways{.ratio = 0.8F, .mutual = true};
  ASSERT_EQ(match(queries, doubled, one_way).size(), 1U);
  EXPECT_EQ(match(queries, doubled, one_way)[0].source, 1U);
  EXPECT_EQ(match(queries, doubled, both_ways).size(), 0U);
}

TEST(DescriptorMatching, OnlySelectedDescriptorsTakePart) {
  const std::vector<Descriptor256> references = random_descriptors(20);
  const std::vector<std::uint32_t> some = {2, 5, 7}, others = {5, 9};
  Matcher matcher;
  const auto& matches = matcher.match({references, some}, {references, others}, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].source, 5U);
  EXPECT_EQ(matches[0].feature, 5U);
  EXPECT_TRUE(matcher.match({references, some}, {references, {}}, {}).empty());
}

}  // namespace
}  // namespace holdfast
