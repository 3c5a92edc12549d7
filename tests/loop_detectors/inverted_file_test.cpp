// SPDX-License-Identifier: BSD-3-Clause
#include "inverted_file.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {
namespace {

using Reference = std::map<std::uint32_t, std::set<std::uint32_t>>;  // word, keyframes

void expect_same(const InvertedFile& inverted, const Reference& reference, std::uint32_t words) {
  for (std::uint32_t word = 0; word < words; ++word) {
    const auto keyframes = inverted.keyframes(word);
    const std::set<std::uint32_t> found(keyframes.begin(), keyframes.end());
    ASSERT_EQ(found.size(), keyframes.size()) << "word " << word;
    const auto expected = reference.find(word);
    ASSERT_EQ(found, expected == reference.end() ? std::set<std::uint32_t>{} : expected->second) << "word " << word;
  }
}

TEST(InvertedFile, AgreesWithAMapOfSets) {
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
    auto& expected = reference[word];
    if (expected.contains(keyframe)) {
      if (filling) continue;
      expected.erase(keyframe);
      EXPECT_EQ(inverted.remove(word, keyframe), expected.empty());
    } else if (filling) {
      expected.insert(keyframe);
      inverted.add(word, keyframe);
    }
    if (step % 500 == 0) expect_same(inverted, reference, words);
  }
  expect_same(inverted, reference, words);
}

TEST(InvertedFile, RefusesToRemoveWhatIsNotThere) {
  InvertedFile inverted;
  inverted.add(2, 7);
  EXPECT_THROW(inverted.remove(2, 8), CheckError);
  EXPECT_THROW(inverted.remove(1, 7), CheckError);
  EXPECT_THROW(inverted.remove(3, 7), CheckError);
  EXPECT_TRUE(inverted.remove(2, 7));
  EXPECT_TRUE(inverted.keyframes(2).empty());
}

}  // namespace
}  // namespace holdfast::flann_plugin
