// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/duration_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {
namespace {

/// Durations over five orders of magnitude.
std::vector<double> durations(std::size_t count) {
  Random random(7);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(std::pow(10.0, random.uniform(-5.0, 0.0)));
  return values;
}

DurationRecord record_of(const std::vector<double>& values) {
  DurationRecord record;
  for (const double value : values) record.add(value);
  return record;
}

TEST(DurationRecord, IsExactForShortRuns) {
  const std::vector<double> values = durations(DurationRecord::exact_count);
  const DurationRecord record = record_of(values);
  EXPECT_EQ(record.count(), values.size());
  for (const double percent : {0.0, 5.0, 50.0, 95.0, 100.0})
    EXPECT_EQ(record.percentile(percent), percentile(values, percent)) << percent;
}

TEST(DurationRecord, IsWithinHalfAPercentForLongRuns) {
  const std::vector<double> values = durations(20 * DurationRecord::exact_count);
  const DurationRecord record = record_of(values);
  EXPECT_EQ(record.count(), values.size());
  for (const double percent : {0.0, 5.0, 50.0, 95.0, 99.9})
    EXPECT_NEAR(record.percentile(percent) / percentile(values, percent), 1.0, 0.0051) << percent;
  EXPECT_EQ(record.percentile(100.0), percentile(values, 100.0));
  EXPECT_EQ(record.maximum(), percentile(values, 100.0));
  double total = 0.0;
  for (const double value : values) total += value;
  EXPECT_EQ(record.total(), total);
}

TEST(DurationRecord, CountsWhatIsOutsideItsIntervals) {
  std::vector<double> values(DurationRecord::exact_count + 1, 0.0);
  values.push_back(1e9);
  const DurationRecord record = record_of(values);
  EXPECT_LE(record.median(), 1.01e-7);
  EXPECT_EQ(record.maximum(), 1e9);
}

TEST(DurationRecord, HasNoPercentileWithoutValues) {
  EXPECT_TRUE(std::isnan(DurationRecord().median()));
  EXPECT_EQ(DurationRecord().maximum(), 0.0);
}

}  // namespace
}  // namespace holdfast
