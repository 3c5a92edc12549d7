// SPDX-License-Identifier: BSD-3-Clause
#include "vocabulary.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "holdfast/core/error.hpp"
#include "loop_detectors/descriptors.hpp"

namespace holdfast::flann_plugin {
namespace {

const Descriptor256 zeros;

std::map<WordId, Descriptor256> fill(Vocabulary& vocabulary, int count, Random& random) {
  std::map<WordId, Descriptor256> words;
  for (int i = 0; i < count; ++i) {
    const Descriptor256 descriptor = test::random_descriptor(random);
    words[vocabulary.insert(&descriptor, vocabulary.find(&descriptor).bucket)] = descriptor;
    vocabulary.split_full_buckets();
  }
  return words;
}

TEST(Vocabulary, KnowsNoWordAtFirst) {
  const Vocabulary vocabulary({}, 1, 32.0F, 4, 64);
  EXPECT_EQ(vocabulary.find(&zeros).count, 0U);
  EXPECT_EQ(vocabulary.size(), 0U);
}

TEST(Vocabulary, FindsWordsAmongMany) {
  Random random(2);
  Vocabulary vocabulary({}, 1, 32.0F, 4, 64);
  const auto words = fill(vocabulary, 5000, random);
  EXPECT_EQ(vocabulary.size(), 5000U);
  EXPECT_EQ(words.size(), 5000U) << "an id was given twice";
  EXPECT_GT(vocabulary.buckets(), 20U);
  int found_exactly = 0;
  int found_disturbed = 0;
  for (const auto& [word, descriptor] : words) {
    const Lookup lookup = vocabulary.find(&descriptor);
    if (lookup.count > 0 && lookup.words[0] == word) ++found_exactly;
    const Descriptor256 other = test::disturbed(descriptor, 15, random);
    const Lookup near = vocabulary.find(&other);
    if (near.count > 0 && near.words[0] == word) ++found_disturbed;
  }
  EXPECT_GT(found_exactly, 4500);
  EXPECT_GT(found_disturbed, 3000);
}

TEST(Vocabulary, WordsWithinTheRadiusNearestFirst) {
  const auto with_bits = [](int count) {
    Descriptor256 descriptor;
    for (int bit = 0; bit < count; ++bit) descriptor.words[static_cast<std::size_t>(bit / 64)] |= 1ULL << (bit % 64);
    return descriptor;
  };
  Vocabulary vocabulary({}, 1, 32.0F, 4, 64);
  std::map<int, WordId> words;
  for (const int bits : {33, 20, 32, 5, 0}) {
    const Descriptor256 descriptor = with_bits(bits);
    words[bits] = vocabulary.insert(&descriptor, 0);
  }
  const Lookup lookup = vocabulary.find(&zeros);
  ASSERT_EQ(lookup.count, 4U);
  EXPECT_EQ(lookup.words, (std::array{words[0], words[5], words[20], words[32]}));
  const Descriptor256 one_bit = with_bits(1);
  vocabulary.insert(&one_bit, 0);
  EXPECT_EQ(vocabulary.find(&zeros).words[3], words[20]);
}

TEST(Vocabulary, ErasedWordsAreGoneAndTheirRoomIsUsedAgain) {
  Random random(3);
  Vocabulary vocabulary({}, 1, 32.0F, 64, 10000);
  const auto words = fill(vocabulary, 2000, random);
  const std::size_t buckets = vocabulary.buckets();
  for (const auto& [word, descriptor] : words)
    if (word % 2 == 0) vocabulary.erase(word);
  EXPECT_EQ(vocabulary.size(), 1000U);
  for (const auto& [word, descriptor] : words) {
    const Lookup lookup = vocabulary.find(&descriptor);
    const bool found = lookup.count > 0 && lookup.words[0] == word;
    EXPECT_EQ(found, word % 2 == 1) << "word " << word;
  }
  const auto more = fill(vocabulary, 1000, random);
  for (const auto& [word, descriptor] : more) EXPECT_LT(word, 2000U);
  EXPECT_LT(vocabulary.buckets(), buckets + buckets / 2);
  EXPECT_THROW(vocabulary.erase(5000), CheckError);
}

TEST(Vocabulary, EmptyBucketsAreGivenUp) {
  Random random(4);
  Vocabulary vocabulary({}, 1, 32.0F, 64, 10000);
  std::map<WordId, Descriptor256> kept = fill(vocabulary, 300, random);
  std::size_t most_buckets = 0;
  for (int cycle = 0; cycle < 6; ++cycle) {
    for (const auto& [word, descriptor] : fill(vocabulary, 4000, random)) vocabulary.erase(word);
    most_buckets = std::max(most_buckets, vocabulary.buckets());
    vocabulary.drop_empty_buckets();
  }
  EXPECT_LT(most_buckets, 4 * 4300 / 64U);
  for (const auto& [word, descriptor] : kept) {
    const Lookup lookup = vocabulary.find(&descriptor);
    ASSERT_GT(lookup.count, 0U);
    EXPECT_EQ(lookup.words[0], word);
  }
  for (const auto& [word, descriptor] : kept) vocabulary.erase(word);
  vocabulary.drop_empty_buckets();
  EXPECT_EQ(vocabulary.buckets(), 0U);
  EXPECT_EQ(vocabulary.find(&zeros).count, 0U);
  fill(vocabulary, 10, random);
  EXPECT_EQ(vocabulary.size(), 10U);
}

TEST(Vocabulary, ErasingTwiceIsRefused) {
  Vocabulary vocabulary({}, 1, 32.0F, 4, 64);
  const WordId word = vocabulary.insert(&zeros, 0);
  vocabulary.erase(word);
  EXPECT_THROW(vocabulary.erase(word), CheckError);
}

TEST(Vocabulary, BucketsThatCannotBeSplitStillWork) {
  Vocabulary vocabulary({}, 1, 32.0F, 4, 64);
  for (int i = 0; i < 500; ++i) {
    vocabulary.insert(&zeros, vocabulary.find(&zeros).bucket);
    vocabulary.split_full_buckets();
  }
  EXPECT_EQ(vocabulary.size(), 500U);
  EXPECT_EQ(vocabulary.find(&zeros).count, Lookup::most_words);
}

}  // namespace
}  // namespace holdfast::flann_plugin
