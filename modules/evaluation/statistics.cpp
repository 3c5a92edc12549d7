// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace holdfast {

double percentile(std::span<const double> values, double percent) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted(values.begin(), values.end());
  const double rank = std::clamp(percent / 100.0, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = sorted.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(sorted.begin(), below, sorted.end());
  const double fraction = rank - std::floor(rank);
  if (fraction == 0.0) return *below;
  return *below + fraction * (*std::min_element(below + 1, sorted.end()) - *below);
}

double median(std::span<const double> values) { return percentile(values, 50.0); }

Statistics statistics_of(std::span<const double> values) {
  Statistics result;
  result.count = values.size();
  if (values.empty()) return result;
  const double count = static_cast<double>(values.size());
  double sum = 0.0, sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  result.mean = sum / count;
  result.rmse = std::sqrt(sum_of_squares / count);
  double squared_deviations = 0.0;
  for (const double value : values) squared_deviations += (value - result.mean) * (value - result.mean);
  result.standard_deviation = std::sqrt(squared_deviations / count);
  const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
  result.minimum = *minimum;
  result.maximum = *maximum;
  result.median = median(values);
  return result;
}

}  // namespace holdfast
