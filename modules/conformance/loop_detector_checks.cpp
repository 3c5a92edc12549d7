// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "check.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/loop_detector.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/loop_detector.hpp";
using Descriptors = std::vector<Descriptor256>;

/// Features of a place on a visit: its own descriptors, each with a few bits of noise.
Descriptors features(std::uint64_t place, std::uint64_t visit, int count) {
  Random of_place(1000 + place), of_visit = Random(7).fork(place).fork(visit);
  Descriptors descriptors(static_cast<std::size_t>(count));
  for (Descriptor256& descriptor : descriptors) {
    for (std::uint64_t& word : descriptor.words) word = of_place.next();
    for (int flip = 0; flip < 6; ++flip) {
      const std::uint32_t bit = of_visit.below(256);
      descriptor.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
  }
  return descriptors;
}

/// An image of a place on a visit: its own coloured squares, each pixel with some noise.
cv::Mat image(std::uint64_t place, std::uint64_t visit) {
  constexpr int rows = 240, columns = 320, square = 40;
  Random of_place(1000 + place), of_visit = Random(7).fork(place).fork(visit);
  cv::Mat image(rows, columns, CV_8UC3);
  for (int top = 0; top < rows; top += square)
    for (int left = 0; left < columns; left += square)
      image(cv::Rect(left, top, square, square)) =
          cv::Scalar(20 + of_place.below(200), 20 + of_place.below(200), 20 + of_place.below(200));
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < 3 * columns; ++k)
      image.ptr<std::uint8_t>(row)[k] += static_cast<std::uint8_t>(of_visit.below(9));
  return image;
}

/// What a place looks like on a visit, to a detector of features or of images; an image has no number of features.
DescriptorBlock view(LoopDetector& detector, std::uint64_t place, std::uint64_t visit, int count = 300) {
  if (detector.image_descriptor()) return detector.describe(image(place, visit), {});
  DescriptorBlock block;
  for (const Descriptor256& descriptor : features(place, visit, count)) block.push_back(descriptor);
  return block;
}

KeyFrameId id(std::uint64_t place) {
  return {static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(place % 3)};
}

constexpr std::uint64_t places = 20;
void add_places(LoopDetector& detector) {
  for (std::uint64_t place = 0; place < places; ++place) detector.add(id(place), view(detector, place, 0));
}

/// Checks the contract of matches, which holds for every query.
void expect_sound(const std::vector<PlaceMatch>& matches, const std::set<KeyFrameId>& known, int max_count) {
  ASSERT_LE(static_cast<int>(matches.size()), std::max(max_count, 0)) << "more matches than were asked for";
  std::set<KeyFrameId> seen;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const PlaceMatch& match = matches[i];
    EXPECT_TRUE(known.count(match.keyframe) > 0) << "a match with keyframe " << match.keyframe.slot << "."
                                                 << match.keyframe.generation << ", which is not known";
    EXPECT_TRUE(seen.insert(match.keyframe).second) << "keyframe " << match.keyframe.slot << " stands there twice";
    ASSERT_TRUE(std::isfinite(match.score)) << "a score is " << match.score;
    if (i == 0) continue;
    ASSERT_GE(matches[i - 1].score, match.score) << "match " << i << " is better than the one before";
    if (matches[i - 1].score == match.score) {
      EXPECT_LT(matches[i - 1].keyframe, match.keyframe) << "equal scores, but not by rising id";
    }
  }
}

std::set<KeyFrameId> all_ids() {
  std::set<KeyFrameId> ids;
  for (std::uint64_t place = 0; place < places; ++place) ids.insert(id(place));
  return ids;
}

bool finds_nothing_by_design(const Maker& maker) {
  return dynamic_cast<NullLoopDetector*>(maker.make<LoopDetector>().get()) != nullptr;
}

void recognises_a_place(const Maker& maker) {
  if (finds_nothing_by_design(maker)) GTEST_SKIP() << "NullLoopDetector recognises nothing";
  const auto detector = maker.make<LoopDetector>();
  add_places(*detector);
  for (const std::uint64_t place : {0U, 7U, 19U}) {
    const auto matches = detector->query(view(*detector, place, 1), 3);
    ASSERT_FALSE(matches.empty()) << "a place of 300 descriptors, seen again with 6 of 256 bits changed in each";
    EXPECT_EQ(matches[0].keyframe, id(place)) << "the best match of place " << place;
  }
}

void matches_are_sound(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  add_places(*detector);
  detector->add({500, 1}, view(*detector, 3, 0));  // looks exactly like place 3
  std::set<KeyFrameId> known = all_ids();
  known.insert({500, 1});
  for (const int max_count : {1, 2, 5, 1000})
    expect_sound(detector->query(view(*detector, 3, 0), max_count), known, max_count);
  for (std::uint64_t place = 0; place < places; ++place)
    expect_sound(detector->query(view(*detector, place, 2), 4), known, 4);
}

void gives_at_most_what_was_asked(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  add_places(*detector);
  for (const int max_count : {0, -1})
    EXPECT_TRUE(detector->query(view(*detector, 1, 0), max_count).empty()) << max_count << " were asked for";
}

void forgets_what_is_removed(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  add_places(*detector);
  std::set<KeyFrameId> known = all_ids();
  for (const std::uint64_t place : {0U, 5U, 19U}) {
    detector->remove(id(place));
    known.erase(id(place));
    expect_sound(detector->query(view(*detector, place, 0), 1000), known, 1000);
  }
  detector->add(id(5), view(*detector, 5, 3));  // and it may come back
  known.insert(id(5));
  expect_sound(detector->query(view(*detector, 5, 4), 1000), known, 1000);
  for (const KeyFrameId& keyframe : all_ids()) detector->remove(keyframe);
  EXPECT_TRUE(detector->query(view(*detector, 2, 0), 10).empty()) << "all were removed";
}

void ignores_unknown_removals(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  detector->remove(id(3));
  add_places(*detector);
  detector->remove({77, 0});
  detector->remove({3, 2});  // the slot is used, the generation is another
  expect_sound(detector->query(view(*detector, 3, 0), 1000), all_ids(), 1000);
}

/// Descriptors of no place, all alike; for a detector of images one image without anything in it.
DescriptorBlock blank(LoopDetector& detector, std::size_t count) {
  if (detector.image_descriptor()) return detector.describe(cv::Mat::zeros(240, 320, CV_8UC3), {});
  return DescriptorBlock(DescriptorType(), count);
}

void lives_with_any_number_of_descriptors(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  EXPECT_TRUE(detector->query({}, 5).empty()) << "nothing was added";
  EXPECT_TRUE(detector->query(view(*detector, 0, 0), 5).empty()) << "nothing was added";
  const std::set<KeyFrameId> known{{1, 0}, {2, 0}, {3, 0}, {4, 0}};
  detector->add({1, 0}, DescriptorBlock());
  detector->add({2, 0}, view(*detector, 2, 0, 1));
  detector->add({3, 0}, blank(*detector, 400));
  detector->add({4, 0}, view(*detector, 4, 0, 5000));
  for (const DescriptorBlock& asked :
       {DescriptorBlock(), view(*detector, 2, 0, 1), blank(*detector, 700), view(*detector, 4, 1, 5000)})
    expect_sound(detector->query(asked, 10), known, 10);
  for (const KeyFrameId& keyframe : known) detector->remove(keyframe);
  EXPECT_TRUE(detector->query(blank(*detector, 3), 5).empty()) << "all were removed";
}

void describes_images_alike(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  if (!detector->image_descriptor()) GTEST_SKIP() << "recognises places by the descriptors of features";
  const DescriptorBlock first = detector->describe(image(3, 0), {});
  ASSERT_FALSE(first.empty()) << "an image of coloured squares was not described";
  EXPECT_TRUE(first.type().is_comparable(*detector->image_descriptor()))
      << "made " << to_string(first.type()) << ", promised " << to_string(*detector->image_descriptor());
  detector->describe(image(4, 0), {});
  EXPECT_TRUE(first == detector->describe(image(3, 0), {})) << "the same image was described differently";
  EXPECT_TRUE(first == detector->describe(image(3, 0), cv::Mat::zeros(240, 320, CV_8UC1)))
      << "a mask in which nothing moves changed the description";
  cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_NO_THROW(detector->describe(grey, {})) << "a grey image";
  EXPECT_NO_THROW(detector->describe(image(3, 0), cv::Mat(240, 320, CV_8UC1, cv::Scalar(255)))) << "all moves";
}

void does_not_see_what_moves(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  if (!detector->image_descriptor()) GTEST_SKIP() << "recognises places by the descriptors of features";
  cv::Mat moving = cv::Mat::zeros(240, 320, CV_8UC1), one = image(3, 0), other = one.clone();
  const cv::Rect person(100, 60, 80, 180);
  moving(person) = 255;
  one(person) = cv::Scalar(200, 40, 10);
  other(person) = cv::Scalar(10, 220, 130);
  EXPECT_TRUE(detector->describe(one, moving) == detector->describe(other, moving))
      << "pixels that move changed the description of the place";
}

/// Everything that a little history answers.
std::vector<std::pair<KeyFrameId, double>> history(LoopDetector& detector, bool ask_often) {
  std::vector<std::pair<KeyFrameId, double>> answers;
  const auto ask = [&](std::uint64_t place) {
    for (const PlaceMatch& match : detector.query(view(detector, place, 5), 6))
      answers.emplace_back(match.keyframe, match.score);
  };
  for (std::uint64_t place = 0; place < places; ++place) {
    detector.add(id(place), view(detector, place, 0));
    if (ask_often) detector.query(view(detector, place / 2, 9), 5);
    if (place % 4 == 3) ask(place / 2);
    if (place % 7 == 6) detector.remove(id(place - 3));
  }
  for (std::uint64_t place = 0; place < places; ++place) ask(place);
  return answers;
}

void same_calls_same_matches(const Maker& maker) {
  EXPECT_TRUE(history(*maker.make<LoopDetector>(), false) == history(*maker.make<LoopDetector>(), false))
      << "two instances gave different matches";
}

void asking_changes_nothing(const Maker& maker) {
  EXPECT_TRUE(history(*maker.make<LoopDetector>(), false) == history(*maker.make<LoopDetector>(), true))
      << "queries in between changed later matches";
}

void may_change_threads(const Maker& maker) {
  const auto here = history(*maker.make<LoopDetector>(), false);
  const auto detector = maker.make<LoopDetector>();
  std::vector<std::pair<KeyFrameId, double>> there;
  run_side_by_side([&] { there = history(*detector, false); }, [] {});
  EXPECT_TRUE(here == there) << "in another thread than the one that made it, the matches differ";
}

void instances_do_not_meet(const Maker& maker) {
  const auto alone = history(*maker.make<LoopDetector>(), false);
  const auto one = maker.make<LoopDetector>(), two = maker.make<LoopDetector>();
  std::vector<std::pair<KeyFrameId, double>> first, second;
  run_side_by_side([&] { first = history(*one, false); }, [&] { second = history(*two, false); });
  EXPECT_TRUE(alone == first && alone == second) << "beside another instance in another thread, the matches differ";
}

void time(const Maker& maker) {
  const auto detector = maker.make<LoopDetector>();
  add_places(*detector);
  std::uint64_t place = 0;
  report_time("loop_detector/" + maker.entry().description.name + ", query of 1000 among 20", 9,
              [&] { detector->query(view(*detector, place++, 1, 1000), 5); });
}

}  // namespace

std::vector<Check> loop_detector_checks() {
  const Promise up_to{header,
                      "Returns up to `max_count` keyframes of the database by decreasing score, equal scores by "
                      "increasing id, without duplicates. Scores are finite."};
  const Promise remove{header, "Removes a keyframe from the database; an unknown id is ignored."};
  const Promise same{
      header, "The same calls in the same order give the same matches, and a query does not affect later results."};
  const Promise threads{header, "Used by one thread at a time, but for describe()."};
  return {
      {"RecognisesAPlace",
       {header, "A keyframe similar to the query; a larger score means greater similarity."},
       recognises_a_place},
      {"MatchesAreSound", up_to, matches_are_sound},
      {"GivesAtMostWhatWasAsked", up_to, gives_at_most_what_was_asked},
      {"ForgetsWhatIsRemoved", remove, forgets_what_is_removed},
      {"IgnoresUnknownRemovals", remove, ignores_unknown_removals},
      {"LivesWithAnyNumberOfDescriptors",
       {header, "Adds a keyframe with any number of descriptors, of its static features or from describe()."},
       lives_with_any_number_of_descriptors},
      {"DescribesImagesAlike", {header, "The same image gives the same descriptors."}, describes_images_alike},
      {"DoesNotSeeWhatMoves",
       {header,
        "`moving`: 8UC1 of the same size, not 0 where something moves that does not belong to the place, or empty."},
       does_not_see_what_moves},
      {"SameCallsSameMatches", same, same_calls_same_matches},
      {"AskingChangesNothing", same, asking_changes_nothing},
      {"MayChangeThreads", threads, may_change_threads},
      {"InstancesDoNotMeet", threads, instances_do_not_meet},
      {"Time", threads, time},
  };
}

}  // namespace holdfast::conformance
