// SPDX-License-Identifier: BSD-3-Clause
#include "inverted_file.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {
namespace {

using Reference = std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>>;  // word, keyframe, count

void expect_same(const InvertedFile& inverted, const Reference& reference, std::uint32_t words) {
  for (std::uint32_t word = 0; word < words; ++word) {
    std::map<std::uint32_t, std::uint32_t> found;
    for (const Posting& posting : inverted.postings(word)) found[posting.keyframe] = posting.count;
    ASSERT_EQ(found.size(), inverted.postings(word).size()) << "word " << word;
    const auto expected = reference.find(word);
    ASSERT_EQ(found, expected == reference.end() ? decltype(found){} : expected->second) << "word " << word;
  }
}

TEST(InvertedFile, AgreesWithAMapOfMaps) {
  constexpr std::uint32_t words = 30;
  constexpr std::uint32_t keyframes = 60;
  InvertedFile inverted;
  Reference reference;
  Random random(3);
  for (int step = 0; step < 6000; ++step) {
    const std::uint32_t word = random.below(words);
    const std::uint32_t keyframe = random.below(keyframes);
    // Mostly filled, then mostly emptied: long lists grow and shrink through every room.
    const bool filling = step % 2000 < 1200;
    auto& postings = reference[word];
    if (postings.contains(keyframe)) {
      if (filling) continue;
      postings.erase(keyframe);
      EXPECT_EQ(inverted.remove(word, keyframe), postings.empty());
    } else if (filling) {
      const std::uint32_t count = 1 + random.below(255);
      postings[keyframe] = count;
      inverted.add(word, {keyframe, count});
    }
    if (step % 500 == 0) expect_same(inverted, reference, words);
  }
  expect_same(inverted, reference, words);
}

TEST(InvertedFile, RefusesToRemoveWhatIsNotThere) {
  InvertedFile inverted;
  inverted.add(2, {7, 1});
  EXPECT_THROW(inverted.remove(2, 8), CheckError);
  EXPECT_THROW(inverted.remove(1, 7), CheckError);
  EXPECT_THROW(inverted.remove(3, 7), CheckError);
  EXPECT_TRUE(inverted.remove(2, 7));
  EXPECT_TRUE(inverted.postings(2).empty());
}

TEST(InvertedFile, HoldsTheLargestKeyframeAndCount) {
  InvertedFile inverted;
  inverted.add(0, {most_keyframes - 1, 255});
  ASSERT_EQ(inverted.postings(0).size(), 1U);
  EXPECT_EQ(inverted.postings(0)[0].keyframe, most_keyframes - 1);
  EXPECT_EQ(inverted.postings(0)[0].count, 255U);
}

}  // namespace
}  // namespace holdfast::flann_plugin
