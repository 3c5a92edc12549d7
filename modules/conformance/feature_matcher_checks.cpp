// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "check.hpp"
#include "filter_scene.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/feature_matcher.hpp";

std::vector<std::uint32_t> all_of(const Frame& frame) {
  std::vector<std::uint32_t> all(frame.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// Every second feature.
std::vector<std::uint32_t> half_of(const Frame& frame) {
  std::vector<std::uint32_t> half;
  for (std::uint32_t i = 0; i < frame.size(); i += 2) half.push_back(i);
  return half;
}

constexpr float max_distance = 40.0F;

std::vector<FeatureMatch> match(const FeatureMatcher& matcher, const MatchSide& queries, const MatchSide& references) {
  std::vector<FeatureMatch> matches{{7, 7, 7.0F}};  // what was there is replaced
  matcher.match(queries, references, {.max_distance = max_distance, .ratio = 0.9F, .mutual = true}, matches);
  return matches;
}

bool is_in(const std::vector<std::uint32_t>& selection, std::uint32_t i) {
  return std::binary_search(selection.begin(), selection.end(), i);
}

/// Checks what holds for all matches: their members are of the selections, and at most once each.
void expect_sound(const std::vector<FeatureMatch>& matches, const std::vector<std::uint32_t>& queries,
                  const std::vector<std::uint32_t>& references) {
  std::set<std::uint32_t> sources;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    EXPECT_TRUE(is_in(queries, matches[i].source)) << "query " << matches[i].source << " does not take part";
    EXPECT_TRUE(is_in(references, matches[i].feature)) << "reference " << matches[i].feature << " does not take part";
    EXPECT_TRUE(sources.insert(matches[i].source).second) << "query " << matches[i].source << " is matched twice";
    ASSERT_TRUE(std::isfinite(matches[i].distance)) << "a distance is " << matches[i].distance;
    if (i == 0) continue;
    EXPECT_LT(matches[i - 1].feature, matches[i].feature) << "match " << i << " is not ordered by reference";
  }
}

int true_ones(const std::vector<FeatureMatch>& matches, const Frame& a, const Frame& b) {
  return static_cast<int>(std::count_if(matches.begin(), matches.end(), [&](const FeatureMatch& match) {
    return a.map_points[match.source] == b.map_points[match.feature];
  }));
}

int shared_points(const Frame& a, const Frame& b) {
  const std::set<MapPointId> there(b.map_points.begin(), b.map_points.end());
  return static_cast<int>(std::count_if(a.map_points.begin(), a.map_points.end(),
                                        [&](MapPointId id) { return id.valid() && there.count(id) > 0; }));
}

void finds_what_both_show(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[2].frame;
  const auto in_a = all_of(a), in_b = all_of(b);
  const std::vector<FeatureMatch> matches = match(*matcher, side_of(a, in_a), side_of(b, in_b));
  expect_sound(matches, in_a, in_b);
  EXPECT_GE(2 * true_ones(matches, a, b), shared_points(a, b)) << "fewer than half of the points that both frames show";
  EXPECT_GE(10 * true_ones(matches, a, b), 9 * static_cast<int>(matches.size())) << "more than a tenth is wrong";
}

void honours_selections(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[1].frame;
  const auto half_a = half_of(a), half_b = half_of(b);
  expect_sound(match(*matcher, side_of(a, half_a), side_of(b, half_b)), half_a, half_b);
}

void matches_points_of_a_map(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[1].frame;
  const auto in_a = all_of(a), in_b = all_of(b);
  const MatchSide points{.descriptors = b.features.descriptors, .selection = in_b};
  const std::vector<FeatureMatch> matches = match(*matcher, side_of(a, in_a), points);
  expect_sound(matches, in_a, in_b);
  EXPECT_GE(2 * true_ones(matches, a, b), shared_points(a, b)) << "points without positions in an image";
}

void lives_with_empty_sides(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame& frame = scene.moments()[0].frame;
  const std::vector<std::uint32_t> none, all = all_of(frame), one{3};
  EXPECT_TRUE(match(*matcher, side_of(frame, none), side_of(frame, all)).empty()) << "no query takes part";
  EXPECT_TRUE(match(*matcher, side_of(frame, all), side_of(frame, none)).empty()) << "no reference takes part";
  EXPECT_TRUE(match(*matcher, {}, {}).empty()) << "both sides are empty";
  expect_sound(match(*matcher, side_of(frame, one), side_of(frame, one)), one, one);
}

/// Points of the first frame, searched for in the second around their true positions.
std::vector<FeatureMatch> match_guided(const FeatureMatcher& matcher, const Frame& a, const Frame& b,
                                       std::span<const std::uint8_t> usable) {
  matching::SearchWindows windows;
  for (std::uint32_t i = 0; i < a.size(); ++i)
    for (std::uint32_t k = 0; k < b.size(); ++k)
      if (a.map_points[i] == b.map_points[k])
        windows.add(i, {{b.x[k], b.y[k], b.right_x[k]}, 5.0F, 0, b.pyramid->levels() - 1});
  std::vector<FeatureMatch> matches{{7, 7, 7.0F}};
  matcher.match_guided(b, {windows, a.features.descriptors}, {.max_distance = max_distance}, usable, matches);
  return matches;
}

void finds_what_is_predicted(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[2].frame;
  const std::vector<FeatureMatch> matches = match_guided(*matcher, a, b, {});
  expect_sound(matches, all_of(a), all_of(b));
  EXPECT_GE(10 * true_ones(matches, a, b), 8 * shared_points(a, b)) << "the predictions were exact";
}

void honours_usable(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[1].frame;
  std::vector<std::uint8_t> usable(b.size(), 0);
  const std::vector<std::uint32_t> half = half_of(b);
  for (const std::uint32_t i : half) usable[i] = 1;
  expect_sound(match_guided(*matcher, a, b, usable), all_of(a), half);
}

bool are_same(const std::vector<FeatureMatch>& a, const std::vector<FeatureMatch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FeatureMatch& x, const FeatureMatch& y) {
    return x.source == y.source && x.feature == y.feature && x.distance == y.distance;
  });
}

void same_arguments_same_matches(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[1].frame, &c = scene.moments()[3].frame;
  const auto in_a = all_of(a), in_b = all_of(b), in_c = all_of(c);
  const auto first = match(*matcher, side_of(a, in_a), side_of(b, in_b));
  const auto guided = match_guided(*matcher, a, b, {});
  match(*matcher, side_of(c, in_c), side_of(a, in_a));
  match_guided(*matcher, b, c, {});
  EXPECT_TRUE(are_same(first, match(*matcher, side_of(a, in_a), side_of(b, in_b)))) << "after another comparison";
  EXPECT_TRUE(are_same(guided, match_guided(*matcher, a, b, {}))) << "after another guided search";
  EXPECT_TRUE(are_same(first, match(*maker.make<FeatureMatcher>(), side_of(a, in_a), side_of(b, in_b))))
      << "by a second instance";
}

void serves_several_threads(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto matcher = maker.make<FeatureMatcher>();
  const Frame &a = scene.moments()[0].frame, &b = scene.moments()[1].frame;
  const auto in_a = all_of(a), in_b = all_of(b);
  const auto forth = match(*matcher, side_of(a, in_a), side_of(b, in_b));
  const auto back = match(*matcher, side_of(b, in_b), side_of(a, in_a));
  const auto guided = match_guided(*matcher, a, b, {});
  bool same_forth = true, same_back = true, same_guided = true;
  run_side_by_side(
      [&] {
        for (int i = 0; i < 10; ++i)
          same_forth = same_forth && are_same(forth, match(*matcher, side_of(a, in_a), side_of(b, in_b)));
      },
      [&] {
        for (int i = 0; i < 10; ++i) {
          same_back = same_back && are_same(back, match(*matcher, side_of(b, in_b), side_of(a, in_a)));
          same_guided = same_guided && are_same(guided, match_guided(*matcher, a, b, {}));
        }
      });
  EXPECT_TRUE(same_forth && same_back && same_guided) << "one instance in two threads at once";
}

}  // namespace

std::vector<Check> feature_matcher_checks() {
  const Promise matches{header,
                        "Matches queries with references without any prediction: FeatureMatch::source is a query, "
                        "FeatureMatch::feature a "
                        "reference, each of the selections and at most once; ordered by reference."};
  const Promise guided{header,
                       "Matches points that are predicted in a frame with features within their windows; see "
                       "matching::GuidedSearch, which this is unless a matcher overrides it."};
  const Promise threads{header, "Tracking, local mapping and loop closing call it from several threads at once."};
  return {
      {"FindsWhatBothShow", {header, "Decides which features show the same point."}, finds_what_both_show},
      {"HonoursSelections", matches, honours_selections},
      {"MatchesPointsOfAMap",
       {header, "All are empty for points of a map, which no single image shows."},
       matches_points_of_a_map},
      {"LivesWithEmptySides", matches, lives_with_empty_sides},
      {"FindsWhatIsPredicted", guided, finds_what_is_predicted},
      {"HonoursUsable", guided, honours_usable},
      {"SameArgumentsSameMatches", {header, "The same arguments give the same matches."}, same_arguments_same_matches},
      {"ServesSeveralThreads", threads, serves_several_threads},
  };
}

}  // namespace holdfast::conformance
