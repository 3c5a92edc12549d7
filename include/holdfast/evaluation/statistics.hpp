// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <span>

namespace holdfast {

/// Percentile (0 to 100) with linear interpolation between the two nearest order statistics (definition 7 of Hyndman
/// and Fan 1996, the default of NumPy and R). NaN without values.
double percentile(std::span<const double> values, double percent);

/// The median; the mean of the two central values for an even number of values. NaN without values.
double median(std::span<const double> values);

/// The six statistics of trajectory errors, in the unit of the values. NaN without values.
struct Statistics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::size_t count = 0;
  double rmse = none;                ///< square root of the mean square
  double standard_deviation = none;  ///< of the population: divided by count, not by count - 1
  double maximum = none;
  double minimum = none;
  double mean = none;
  double median = none;
};

/// Computes the statistics. Sums are accumulated in the order of the values, so that equal input gives equal bits.
Statistics statistics_of(std::span<const double> values);

}  // namespace holdfast
