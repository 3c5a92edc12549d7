// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/hamming.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

std::vector<Descriptor> random_descriptors(std::size_t count) {
  Random random(1);
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& descriptor : descriptors)
    for (std::uint64_t& word : descriptor.words) word = random.next() & random.next();
  return descriptors;
}

int count_bit_by_bit(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (int bit = 0; bit < 256; ++bit)
    distance += ((a.words[bit / 64] >> (bit % 64)) & 1) != ((b.words[bit / 64] >> (bit % 64)) & 1);
  return distance;
}

TEST(Hamming, CountsEveryBit) {
  Descriptor none, all;
  all.words.fill(~std::uint64_t{0});
  EXPECT_EQ(hamming_distance(none, none), 0);
  EXPECT_EQ(hamming_distance(none, all), 256);
  for (int bit = 0; bit < 256; ++bit) {
    Descriptor one;
    one.words[bit / 64] = std::uint64_t{1} << (bit % 64);
    EXPECT_EQ(hamming_distance(none, one), 1);
  }
}

TEST(Hamming, KernelsAgreeWithCountingBitByBit) {
  const std::vector<Descriptor> descriptors = random_descriptors(150);
  for (const std::size_t count : {0U, 1U, 3U, 64U, 65U, 150U}) {
    std::vector<std::uint32_t> candidates(count);
    for (std::size_t i = 0; i < count; ++i) candidates[i] = static_cast<std::uint32_t>((i * 7) % 150);
    std::vector<std::uint16_t> distances(count);
    hamming_distances(descriptors[5], descriptors.data(), candidates, distances.data());
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(distances[i], count_bit_by_bit(descriptors[5], descriptors[candidates[i]]));
  }
}

}  // namespace
}  // namespace holdfast
