// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/association.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The definition, word by word: all pairs near enough, sorted, taken one after the other.
Pairs associate_by_definition(const std::vector<double>& a, const std::vector<double>& b, double max_difference) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (std::abs(a[i] - b[j]) < max_difference) candidates.emplace_back(std::abs(a[i] - b[j]), i, j);
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> taken_a(a.size()), taken_b(b.size());
  Pairs pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (taken_a[i] || taken_b[j]) continue;
    taken_a[i] = taken_b[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(AssociateStamps, TakesTheNearestPairFirst) {
  // a[0] would come first in a list order and take b[0], which is nearer to a[1].
  const std::vector<double> a{1.00, 1.03}, b{1.02};
  EXPECT_EQ(associate_stamps(a, b, 0.025), (Pairs{{1, 0}}));
}

TEST(AssociateStamps, TheLimitItselfIsTooFar) {
  const std::vector<double> a{1.0}, b{1.5};
  EXPECT_TRUE(associate_stamps(a, b, 0.5).empty());
  EXPECT_EQ(associate_stamps(a, b, 0.500001).size(), 1u);
  EXPECT_TRUE(associate_stamps(a, a, 0.0).empty());
}

TEST(AssociateStamps, OfEquallyNearPairsTheLowerIndicesCount) {
  const std::vector<double> a{2.0}, b{2.5, 1.5};
  EXPECT_EQ(associate_stamps(a, b, 1.0), (Pairs{{0, 0}}));
  EXPECT_EQ(associate_stamps(b, a, 1.0), (Pairs{{0, 0}}));
}

TEST(AssociateStamps, StampsThatAreNotFinitePairWithNothing) {
  const std::vector<double> a{std::nan(""), 1.0, infinity}, b{infinity, std::nan(""), 1.0};
  EXPECT_EQ(associate_stamps(a, b, infinity), (Pairs{{1, 2}}));
  EXPECT_TRUE(associate_stamps({}, b, 1.0).empty());
}

TEST(AssociateStamps, EqualsItsDefinitionOnRandomLists) {
  Random random(7);
  for (int round = 0; round < 400; ++round) {
    // Multiples of 1/8 in a short span: exact differences, with many ties, repeated stamps and nested pairs.
    std::vector<double> a(random.below(12)), b(random.below(12));
    for (double& stamp : a) stamp = static_cast<double>(random.below(40)) / 8.0;
    for (double& stamp : b) stamp = static_cast<double>(random.below(40)) / 8.0;
    for (const double limit : {0.2, 0.5, 2.0, infinity})
      ASSERT_EQ(associate_stamps(a, b, limit), associate_by_definition(a, b, limit)) << "round " << round;
  }
}

TEST(AssociateStamps, IsNotQuadraticEvenWithoutALimit) {
  // Two hundred thousand stamps each: forty thousand million pairs, were they all looked at.
  std::vector<double> a(200000), b(200000);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = static_cast<double>(i);
    b[i] = static_cast<double>(i) + 0.25;
  }
  const Pairs pairs = associate_stamps(a, b, infinity);
  ASSERT_EQ(pairs.size(), a.size());
  EXPECT_EQ(pairs[199999], (std::pair<std::size_t, std::size_t>{199999, 199999}));
}

}  // namespace
}  // namespace holdfast
