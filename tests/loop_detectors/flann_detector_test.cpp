// SPDX-License-Identifier: BSD-3-Clause
#include "flann_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "loop_detectors/descriptors.hpp"

namespace holdfast::flann_plugin {
namespace {

using test::disturbed;
using test::random_descriptors;
using test::seen_again;
using Descriptors = std::vector<Descriptor256>;

constexpr int size_of_keyframe = 100;

KeyFrameId id(std::uint32_t slot) { return {slot, 1}; }

/// Some places that share nothing.
std::vector<Descriptors> make_places(int count, std::uint64_t seed = 11) {
  Random random(seed);
  std::vector<Descriptors> places;
  for (int i = 0; i < count; ++i) places.push_back(random_descriptors(random, size_of_keyframe));
  return places;
}

std::vector<std::pair<std::uint32_t, double>> plain(const std::vector<PlaceMatch>& matches) {
  std::vector<std::pair<std::uint32_t, double>> result;
  for (const PlaceMatch& match : matches) result.emplace_back(match.keyframe.slot, match.score);
  return result;
}

TEST(FlannDetector, FindsTheSamePlaceAmongMany) {
  FlannDetector detector({});
  const auto places = make_places(150);
  for (std::uint32_t i = 0; i < places.size(); ++i) detector.add(id(i), places[i]);
  Random random(1);
  for (std::uint32_t i = 0; i < places.size(); i += 10) {
    const auto matches = detector.query(seen_again(places[i], 0.5, 15, random), 5);
    ASSERT_FALSE(matches.empty());
    EXPECT_EQ(matches[0].keyframe, id(i));
    EXPECT_GT(matches[0].score, 0.1);
    if (matches.size() > 1) {
      EXPECT_LT(matches[1].score, 0.5 * matches[0].score);
    }
  }
}

TEST(FlannDetector, RanksByWhatIsShared) {
  FlannDetector detector({});
  const auto place = make_places(1)[0];
  Random random(2);
  detector.add(id(3), seen_again(place, 0.2, 0, random));
  detector.add(id(1), seen_again(place, 0.8, 0, random));
  detector.add(id(2), seen_again(place, 0.5, 0, random));
  const auto matches = detector.query(place, 10);
  ASSERT_EQ(matches.size(), 3U);
  EXPECT_EQ(matches[0].keyframe, id(1));
  EXPECT_EQ(matches[1].keyframe, id(2));
  EXPECT_EQ(matches[2].keyframe, id(3));
  EXPECT_EQ(detector.query(place, 2).size(), 2U);
  EXPECT_EQ(detector.query(place, 0).size(), 0U);
}

TEST(FlannDetector, ScoreIsTheShareOfTheQuery) {
  FlannDetector detector({});
  const auto places = make_places(2);
  detector.add(id(0), places[0]);
  // Alone in the map, all weights are log(2): half of the descriptors, half of the score.
  Descriptors half(places[0].begin(), places[0].begin() + size_of_keyframe / 2);
  half.insert(half.end(), places[1].begin(), places[1].begin() + size_of_keyframe / 2);
  EXPECT_DOUBLE_EQ(detector.query(places[0], 1)[0].score, 1.0);
  EXPECT_DOUBLE_EQ(detector.query(half, 1)[0].score, 0.5);
}

TEST(FlannDetector, RareWordsWeighMore) {
  FlannDetector detector({});
  const auto places = make_places(12);
  const Descriptors& common = places[0];
  for (std::uint32_t i = 1; i < 10; ++i) {
    Descriptors view = places[i];
    view.insert(view.end(), common.begin(), common.end());
    detector.add(id(i), view);
  }
  // Half of the query is what all have, half is what only keyframe 5 has: by numbers 5 has all and others half.
  Descriptors query = places[5];
  query.insert(query.end(), common.begin(), common.end());
  const auto matches = detector.query(query, 10);
  ASSERT_EQ(matches.size(), 9U);
  EXPECT_EQ(matches[0].keyframe, id(5));
  EXPECT_GT(matches[0].score, 0.95);
  EXPECT_LT(matches[1].score, 0.3);
}

TEST(FlannDetector, ScoreIsTheShareOfTheWeightsThatVoted) {
  FlannDetector detector({});
  const auto places = make_places(3);
  detector.add(id(0), {{places[0][0], places[1][0]}});
  detector.add(id(1), {{places[0][0], places[2][0]}});
  // Of two keyframes both have the first, one has the second, none has the third.
  const Descriptors query{places[0][0], places[1][0], places[0][1]};
  const double both = std::log(2.0), one = std::log(3.0);
  const auto matches = detector.query(query, 5);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].keyframe, id(0));
  EXPECT_NEAR(matches[0].score, (both + one) / (both + one + one), 1e-3);
  EXPECT_NEAR(matches[1].score, both / (both + one + one), 1e-3);
}

TEST(FlannDetector, EqualScoresByRisingId) {
  FlannDetector detector({});
  const auto place = make_places(1)[0];
  for (const std::uint32_t i : {7U, 2U, 9U, 4U}) detector.add(id(i), place);
  detector.add({2, 0}, place);
  const auto matches = detector.query(place, 5);
  ASSERT_EQ(matches.size(), 5U);
  EXPECT_EQ(matches[0].keyframe, (KeyFrameId{2, 0}));
  EXPECT_EQ(matches[1].keyframe, id(2));
  EXPECT_EQ(matches[2].keyframe, id(4));
  EXPECT_EQ(matches[3].keyframe, id(7));
  EXPECT_EQ(matches[4].keyframe, id(9));
  EXPECT_EQ(matches[0].score, matches[4].score);
}

TEST(FlannDetector, RemovedKeyframesAreNotFound) {
  FlannDetector detector({});
  const auto places = make_places(20);
  for (std::uint32_t i = 0; i < places.size(); ++i) detector.add(id(i), places[i]);
  detector.remove(id(7));
  for (const PlaceMatch& match : detector.query(places[7], 100)) EXPECT_NE(match.keyframe, id(7));
  EXPECT_EQ(detector.query(places[8], 1)[0].keyframe, id(8));
  detector.remove(id(7));
  detector.remove(id(99));
  EXPECT_EQ(detector.keyframes(), 19U);
  detector.add(id(7), places[7]);
  EXPECT_EQ(detector.query(places[7], 1)[0].keyframe, id(7));
}

TEST(FlannDetector, WordsOfRemovedKeyframesAreForgotten) {
  FlannDetector detector({});
  const auto places = make_places(10);
  for (std::uint32_t i = 0; i < places.size(); ++i) detector.add(id(i), places[i]);
  const std::size_t words = detector.words();
  for (std::uint32_t cycle = 0; cycle < 5; ++cycle) {
    const auto others = make_places(10, 100 + cycle);
    for (std::uint32_t i = 0; i < others.size(); ++i) detector.add(id(100 + i), others[i]);
    EXPECT_GT(detector.words(), words + 500);
    for (std::uint32_t i = 0; i < others.size(); ++i) detector.remove(id(100 + i));
    EXPECT_EQ(detector.words(), words);
  }
  for (std::uint32_t i = 0; i < places.size(); ++i) detector.remove(id(i));
  EXPECT_EQ(detector.words(), 0U);
  EXPECT_TRUE(detector.query(places[0], 3).empty());
}

TEST(FlannDetector, AddingTwiceIsRefused) {
  FlannDetector detector({});
  const auto place = make_places(1)[0];
  detector.add(id(1), place);
  EXPECT_THROW(detector.add(id(1), place), CheckError);
}

TEST(FlannDetector, KeyframesWithoutDescriptors) {
  FlannDetector detector({});
  EXPECT_TRUE(detector.query({}, 3).empty());
  detector.add(id(0), {});
  EXPECT_TRUE(detector.query({}, 3).empty());
  const auto place = make_places(1)[0];
  EXPECT_TRUE(detector.query(place, 3).empty());
  detector.add(id(1), place);
  EXPECT_TRUE(detector.query({}, 3).empty());
  EXPECT_EQ(detector.query(place, 3).size(), 1U);
  detector.remove(id(0));
}

TEST(FlannDetector, UsesNoMoreDescriptorsThanAllowed) {
  FlannSettings settings;
  settings.descriptors = 50;
  FlannDetector detector(settings);
  const auto place = make_places(1)[0];
  detector.add(id(0), place);
  EXPECT_EQ(detector.words(), 50U);
  EXPECT_DOUBLE_EQ(detector.query(place, 1)[0].score, 1.0);
}

/// Queries and additions as loop closing makes them; every answer, one after the other.
std::vector<std::pair<std::uint32_t, double>> session(bool query_before_add, bool host_draws,
                                                      FlannDetector* other = nullptr) {
  FlannDetector detector({});
  const auto places = make_places(60, 5);
  Random random(9);
  std::vector<std::pair<std::uint32_t, double>> answers;
  for (std::uint32_t i = 0; i < 120; ++i) {
    const auto view = seen_again(places[(i * 7) % places.size()], 0.5, 20, random);
    if (query_before_add) detector.query(view, 10);
    if (other) other->add(id(i), seen_again(places[i % 60], 0.3, 10, random));
    detector.add(id(i), view);
    if (i % 5 == 4) detector.remove(id(i - 3));
    if (host_draws) std::srand(static_cast<unsigned>(i));
    const auto matches = plain(detector.query(places[i % places.size()], 10));
    answers.insert(answers.end(), matches.begin(), matches.end());
    if (other) other->query(places[i % 60], 4);
  }
  return answers;
}

TEST(FlannDetector, SameCallsSameAnswers) {
  const auto answers = session(true, false);
  ASSERT_GT(answers.size(), 80U);
  EXPECT_EQ(answers, session(true, false));
  EXPECT_EQ(answers, session(true, true)) << "the host's random numbers matter";
  EXPECT_EQ(answers, session(false, false)) << "a query before an addition matters";
}

TEST(FlannDetector, DetectorsInOneProcessDoNotDisturbEachOther) {
  // The other one draws from the same generator of views, so both sessions have one.
  FlannDetector one({});
  CreationContext context;
  context.seed = 77;
  FlannDetector another({}, context);
  EXPECT_EQ(session(true, false, &one), session(true, false, &another));
}

TEST(FlannDetector, ScoresLieBetweenZeroAndOne) {
  FlannDetector detector({});
  Random random(4);
  const auto places = make_places(10);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const std::size_t place = random.below(10);
    auto view = seen_again(places[place], random.uniform(), 30, random);
    view.insert(view.end(), view.begin(), view.begin() + 20);
    for (const PlaceMatch& match : detector.query(view, 300)) {
      EXPECT_GT(match.score, 0.0);
      EXPECT_LE(match.score, 1.0);
    }
    detector.add(id(i), view);
  }
}

TEST(FlannDetector, IsFoundByItsNameInConfigurations) {
  Registry registry;
  register_builtin_plugins(registry);
  const auto detector = registry.create<LoopDetector>("flann", {}, {});
  const auto place = make_places(1)[0];
  detector->add(id(0), place);
  EXPECT_EQ(detector->query(place, 1).size(), 1U);
}

/// What a place of numbers looks like on a visit: its own descriptors, each with a little noise.
DescriptorBlock numbers_of(const DescriptorType& type, std::uint64_t place, std::uint64_t visit) {
  Random of_place(100 + place), of_visit = Random(9).fork(place).fork(visit);
  DescriptorBlock block(type, 200);
  for (std::size_t i = 0; i < block.size(); ++i) {
    std::vector<double> numbers(type.length);
    double squares = 0.0;
    for (double& number : numbers) {
      number = of_place.normal() + 0.1 * of_visit.normal();
      squares += number * number;
    }
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (type.kind == DescriptorKind::float32)
        block.numbers(i)[k] = static_cast<float>(numbers[k] / std::sqrt(squares));
      else
        block.bytes(i)[k] = static_cast<std::byte>(std::lround(20.0 * numbers[k]));
  }
  return block;
}

TEST(FlannDetector, RecognisesPlacesByNumbersAsByBits) {
  const std::vector<DescriptorType> types = {{DescriptorKind::float32, DescriptorMetric::cosine, 64, 0.1F, 0.3F},
                                             {DescriptorKind::float32, DescriptorMetric::euclidean, 100, 0.5F, 0.8F},
                                             {DescriptorKind::int8, DescriptorMetric::euclidean, 32, 50.0F, 80.0F}};
  for (const DescriptorType& type : types) {
    SCOPED_TRACE(to_string(type));
    FlannDetector detector(FlannSettings{});
    constexpr std::uint32_t places = 40;
    for (std::uint32_t place = 0; place < places; ++place) detector.add(id(place), numbers_of(type, place, 0));
    EXPECT_GT(detector.words(), 7000U) << "buckets were split";
    for (std::uint32_t place = 0; place < places; ++place) {
      const auto matches = detector.query(numbers_of(type, place, 1), 2);
      ASSERT_FALSE(matches.empty());
      EXPECT_EQ(matches[0].keyframe, id(place));
      EXPECT_GT(matches[0].score, 0.8);
    }
    detector.remove(id(3));
    for (const PlaceMatch& match : detector.query(numbers_of(type, 3, 1), 10)) EXPECT_NE(match.keyframe, id(3));
  }
}

TEST(FlannDetector, KeepsTypesApart) {
  FlannDetector detector(FlannSettings{});
  detector.add(id(0), DescriptorView());
  EXPECT_TRUE(detector.query(numbers_of({DescriptorKind::int8, DescriptorMetric::euclidean, 8, 1, 2}, 1, 1), 1).empty())
      << "nothing says the type yet";
  detector.add(id(1), numbers_of({DescriptorKind::float32, DescriptorMetric::euclidean, 8, 1, 2}, 1, 1));
  Random random(1);
  EXPECT_THROW(detector.add(id(2), test::random_descriptors(random, 5)), CheckError);
  EXPECT_THROW(detector.query(test::random_descriptors(random, 5), 3), CheckError);
}

TEST(FlannDetector, WeightsOfDescriptors) {
  // Two places that differ in their first half, which changes; the query has the half of the wrong one.
  Random random(5);
  const Descriptors left = random_descriptors(random, 50), right = random_descriptors(random, 50);
  const Descriptors here = random_descriptors(random, 30), there = random_descriptors(random, 50);
  const auto joined = [](Descriptors a, const Descriptors& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  FlannDetector detector({});
  detector.add(id(1), joined(left, here));
  detector.add(id(2), joined(right, there));
  const Descriptors query = joined(right, here);
  std::vector<float> weights(query.size(), 1.0F);
  EXPECT_EQ(detector.query(query, 5)[0].keyframe, id(2));
  EXPECT_EQ(plain(detector.query_weighted(query, weights, 5)), plain(detector.query(query, 5)));
  EXPECT_EQ(plain(detector.query_weighted(query, {}, 5)), plain(detector.query(query, 5)));

  std::fill(weights.begin(), weights.begin() + 50, 0.1F);
  const auto weighted = detector.query_weighted(query, weights, 5);
  ASSERT_EQ(weighted.size(), 2U);
  EXPECT_EQ(weighted[0].keyframe, id(1));
  EXPECT_NEAR(weighted[0].score, 30.0 / 35.0, 0.01);
  EXPECT_NEAR(weighted[1].score, 5.0 / 35.0, 0.01);

  std::fill(weights.begin(), weights.begin() + 50, 0.0F);
  const auto without = detector.query_weighted(query, weights, 5);
  ASSERT_EQ(without.size(), 1U) << "a weight of 0 is no vote";
  EXPECT_EQ(plain(without), plain(detector.query(here, 5)));
  EXPECT_TRUE(detector.query_weighted(query, std::vector<float>(query.size(), 0.0F), 5).empty());
  EXPECT_THROW(detector.query_weighted(query, std::vector<float>(3, 1.0F), 5), CheckError);
}

TEST(FlannDetector, WeightsOfSampledDescriptors) {
  // With more descriptors than are used, each keeps its own weight.
  Random random(6);
  const Descriptors place = random_descriptors(random, 100), other = random_descriptors(random, 100);
  FlannDetector detector({.descriptors = 70});
  detector.add(id(1), place);
  detector.add(id(2), other);
  Descriptors query;
  std::vector<float> weights;
  for (std::size_t i = 0; i < place.size(); ++i) {
    query.push_back(i % 3 == 0 ? other[i] : place[i]);
    weights.push_back(i % 3 == 0 ? 0.0F : 1.0F);
  }
  const auto matches = detector.query_weighted(query, weights, 5);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].keyframe, id(1));
}

}  // namespace
}  // namespace holdfast::flann_plugin
