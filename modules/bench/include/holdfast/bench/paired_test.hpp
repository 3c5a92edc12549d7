// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace holdfast {

/// The signed-rank test of Wilcoxon (1945) for paired differences.
struct SignedRank {
  std::size_t pairs = 0;  ///< that differ; those that do not are left out
  double rank_sum = 0.0;  ///< of the positive differences
  double p = 1.0;         ///< two-sided
};

/// Exact for every size: the distribution of the rank sum over all 2^n signs is computed. Ties get the mean of their
/// ranks, and the distribution takes them into account. The differences must be finite.
SignedRank wilcoxon_signed_rank(std::span<const double> differences);

/// Minimum number of pairs for p < 0.05: with n equal signs p is 2 / 2^n.
inline constexpr std::size_t fewest_pairs_to_test = 6;

/// A confidence interval, in the unit of the values.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// The percentile bootstrap interval (Efron 1979) of the median: the middle 95 % of the medians of `resamples` draws
/// with replacement. Same values and seed, same interval. At least one value.
Interval bootstrap_median(std::span<const double> values, std::uint64_t seed = 1, int resamples = 10000);

/// Step-down correction of Holm (1979) for multiple tests: the corrected p-values in the order of the input.
std::vector<double> holm_adjusted(std::span<const double> p_values);

}  // namespace holdfast
