// SPDX-License-Identifier: BSD-3-Clause
#include "spread.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "holdfast/core/random.hpp"

namespace holdfast::orb_plugin {
namespace {

using Key = std::tuple<int, int, int>;

std::vector<Key> keys(const std::vector<Corner>& corners) {
  std::vector<Key> result;
  for (const Corner& corner : corners) result.emplace_back(corner.x, corner.y, corner.score);
  return result;
}

/// 3000 distinct corners, nine tenths of them, and the strongest, crowded in one corner of the image.
std::vector<Corner> crowded_corners() {
  Random random(3);
  std::set<std::pair<int, int>> seen;
  std::vector<Corner> corners;
  while (corners.size() < 3000) {
    const bool is_crowded = corners.size() < 2700;
    const int x = static_cast<int>(random.below(is_crowded ? 120 : 640));
    const int y = static_cast<int>(random.below(is_crowded ? 120 : 480));
    if (!seen.emplace(x, y).second) continue;
    const auto score = static_cast<std::uint8_t>(is_crowded ? 100 + random.below(150) : 20 + random.below(60));
    corners.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), score});
  }
  return corners;
}

std::size_t occupied_cells(const std::vector<Corner>& corners) {
  std::set<std::pair<int, int>> cells;
  for (const Corner& corner : corners) cells.emplace(corner.x / 40, corner.y / 40);
  return cells.size();
}

TEST(EvenSpread, GivesExactlyWhatIsWantedOfTheCornersGiven) {
  const std::vector<Corner> all = crowded_corners();
  const std::vector<Key> given = keys(all);
  const std::set<Key> given_set(given.begin(), given.end());
  EvenSpread spread;
  for (const std::size_t wanted : {0U, 1U, 2U, 7U, 100U, 500U, 2999U})
    for (const double share : {0.0, 0.4, 1.0}) {
      std::vector<Corner> corners = all;
      spread.select(wanted, static_cast<std::size_t>(static_cast<double>(wanted) * share), corners);
      const std::vector<Key> chosen = keys(corners);
      EXPECT_EQ(chosen.size(), wanted);
      EXPECT_EQ(std::set<Key>(chosen.begin(), chosen.end()).size(), wanted) << "a corner was chosen twice";
      for (const Key& key : chosen) EXPECT_TRUE(given_set.contains(key));
    }
}

TEST(EvenSpread, ReachesSparsePartsOfTheImage) {
  EvenSpread spread;
  std::vector<Corner> by_strength = crowded_corners(), even = by_strength, mixed = by_strength;
  spread.select(300, 0, by_strength);
  spread.select(300, 300, even);
  spread.select(300, 120, mixed);
  EXPECT_LE(occupied_cells(by_strength), 9U);
  EXPECT_GE(occupied_cells(even), 90U);
  EXPECT_GE(occupied_cells(mixed), 50U);
}

TEST(EvenSpread, WithoutSpreadKeepsTheStrongest) {
  EvenSpread spread;
  std::vector<Corner> corners = crowded_corners(), sorted = corners;
  spread.select(250, 0, corners);
  std::sort(sorted.begin(), sorted.end(), [](const Corner& a, const Corner& b) { return a.score > b.score; });
  for (const Corner& corner : corners) EXPECT_GE(corner.score, sorted[249].score);
}

TEST(EvenSpread, DoesNotDependOnTheOrderOfTheCorners) {
  EvenSpread spread;
  std::vector<Corner> corners = crowded_corners(), reversed(corners.rbegin(), corners.rend());
  spread.select(400, 160, corners);
  spread.select(400, 160, reversed);
  EXPECT_EQ(keys(corners), keys(reversed));
}

}  // namespace
}  // namespace holdfast::orb_plugin
