// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace holdfast {
namespace {

TEST(Statistics, AgreesWithFiguresByHand) {
  const std::vector<double> values{3.0, 1.0, 4.0, 8.0};
  const Statistics statistics = statistics_of(values);
  EXPECT_EQ(statistics.count, 4u);
  EXPECT_DOUBLE_EQ(statistics.mean, 4.0);
  EXPECT_DOUBLE_EQ(statistics.median, 3.5);
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(90.0 / 4.0));
  EXPECT_DOUBLE_EQ(statistics.standard_deviation, std::sqrt(26.0 / 4.0));  // of the population, not 26 / 3
  EXPECT_EQ(statistics.minimum, 1.0);
  EXPECT_EQ(statistics.maximum, 8.0);
}

TEST(Statistics, OfOneValueHasNoSpread) {
  const Statistics statistics = statistics_of(std::vector<double>{2.5});
  EXPECT_EQ(statistics.standard_deviation, 0.0);
  EXPECT_EQ(statistics.median, 2.5);
}

TEST(Statistics, OfNothingIsNotANumber) {
  const Statistics statistics = statistics_of({});
  EXPECT_EQ(statistics.count, 0u);
  EXPECT_TRUE(std::isnan(statistics.rmse));
  EXPECT_TRUE(std::isnan(statistics.median));
  EXPECT_TRUE(std::isnan(percentile({}, 95.0)));
}

TEST(Statistics, PercentileInterpolatesBetweenOrderStatistics) {
  const std::vector<double> values{50.0, 15.0, 40.0, 20.0, 35.0};
  EXPECT_DOUBLE_EQ(percentile(values, 40.0), 29.0);
  EXPECT_DOUBLE_EQ(percentile(values, 95.0), 48.0);
  EXPECT_DOUBLE_EQ(percentile(values, 0.0), 15.0);
  EXPECT_DOUBLE_EQ(percentile(values, 100.0), 50.0);
  EXPECT_DOUBLE_EQ(median(values), 35.0);
}

}  // namespace
}  // namespace holdfast
