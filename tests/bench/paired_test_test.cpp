// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/paired_test.hpp"

#include <gmock/gmock.h>

namespace holdfast {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

SignedRank test(const std::vector<double>& differences) { return wilcoxon_signed_rank(differences); }

// By hand: of the 2^n equally likely signs, so many have a rank sum as extreme.
TEST(SignedRankTest, IsExactForSmallSamples) {
  EXPECT_DOUBLE_EQ(test({1, 2, 3, 4, 5, 6}).p, 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(test({1, 2, 3, 4, 5}).p, 2.0 / 32.0);
  // Rank sums of at most 3 of 8: {}, {1}, {2}, {3}, {1, 2}.
  const SignedRank eight = test({0.1, 0.2, -0.3, 0.4, 0.5, 0.6, 0.7, 0.8});
  EXPECT_DOUBLE_EQ(eight.rank_sum, 33.0);
  EXPECT_DOUBLE_EQ(eight.p, 2.0 * 5.0 / 256.0);
  // Signs do not matter, only which side they are on.
  EXPECT_DOUBLE_EQ(test({-0.1, -0.2, 0.3, -0.4, -0.5, -0.6, -0.7, -0.8}).p, eight.p);
  // As many on either side.
  EXPECT_DOUBLE_EQ(test({1, -2, -3, 4}).p, 1.0);
}

TEST(SignedRankTest, SharesRanksAndLeavesOutWhatDoesNotDiffer) {
  const SignedRank shared = test({0, 1, 1, 2, -1, 0});
  EXPECT_EQ(shared.pairs, 4U);
  EXPECT_DOUBLE_EQ(shared.rank_sum, 8.0);  // ranks 2, 2, 2 and 4; the negative one has 2
  // Rank sums of at most 2: {} and each of the three twos.
  EXPECT_DOUBLE_EQ(shared.p, 2.0 * 4.0 / 16.0);
  EXPECT_EQ(test({0, 0}).pairs, 0U);
  EXPECT_DOUBLE_EQ(test({0, 0}).p, 1.0);
  EXPECT_DOUBLE_EQ(test({}).p, 1.0);
}

TEST(SignedRankTest, IsExactForManyPairsToo) {
  std::vector<double> differences;
  for (int i = 1; i <= 60; ++i) differences.push_back(i % 3 == 0 ? -i : i);
  // Counted with whole numbers; the normal approximation has 0.0362.
  EXPECT_THAT(test(differences).p, DoubleNear(0.03556317378476646, 1e-9));
}

TEST(BootstrapTest, IsRepeatableAndHoldsTheMedian) {
  const std::vector<double> values = {3, 1, 4, 1.5, 9, 2.6, 5};
  const Interval interval = bootstrap_median(values);
  EXPECT_EQ(interval.low, bootstrap_median(values).low);
  EXPECT_EQ(interval.high, bootstrap_median(values).high);
  EXPECT_LE(interval.low, 3.0);
  EXPECT_GE(interval.high, 3.0);
  EXPECT_GE(interval.low, 1.0);
  EXPECT_LE(interval.high, 9.0);
  EXPECT_EQ(bootstrap_median(std::vector<double>{2.0}).low, 2.0);
  // The median of 3 draws of {0, 0, 1} is 1 with probability 3 (1/3)^2 (2/3) + (1/3)^3 = 7/27 and 0 otherwise.
  const Interval coins = bootstrap_median(std::vector<double>{0, 0, 1});
  EXPECT_EQ(coins.low, 0.0);
  EXPECT_EQ(coins.high, 1.0);
}

TEST(HolmTest, StepsDown) {
  const std::vector<double> p = {0.04, 0.01, 0.03};
  EXPECT_THAT(holm_adjusted(p), ElementsAre(DoubleNear(0.06, 1e-12), DoubleNear(0.03, 1e-12), DoubleNear(0.06, 1e-12)));
  EXPECT_THAT(holm_adjusted(std::vector<double>{0.6, 0.7}), ElementsAre(1.0, 1.0));
  EXPECT_TRUE(holm_adjusted({}).empty());
}

}  // namespace
}  // namespace holdfast
