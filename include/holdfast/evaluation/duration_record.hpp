// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace holdfast {

/// Durations of a stage over a run of any length, in bounded memory: up to `exact_count` values are kept, and
/// percentiles are exact; more are counted in intervals of 1 % from 0.1 us to 10,000 s, and percentiles are within
/// 0.5 %. Count, total and maximum are always exact. Not synchronised.
class DurationRecord {
 public:
  static constexpr std::size_t exact_count = 4096;

  /// A duration [s], not negative.
  void add(double seconds);

  std::size_t count() const { return count_; }
  bool empty() const { return count_ == 0; }
  double total() const { return total_; }      ///< [s]
  double maximum() const { return maximum_; }  ///< [s]; 0 without values
  /// Percentile (0 to 100) [s], interpolated as by percentile() of statistics.hpp. NaN without values.
  double percentile(double percent) const;
  double median() const { return percentile(50.0); }

 private:
  void count_in_interval(double seconds);
  double value_of_rank(std::uint64_t rank) const;

  std::vector<double> values_;            // empty once there are too many
  std::vector<std::uint64_t> intervals_;  // empty until then
  std::size_t count_ = 0;
  double total_ = 0.0;
  double maximum_ = 0.0;
};

}  // namespace holdfast
