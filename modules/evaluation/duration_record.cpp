// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/duration_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

namespace {

constexpr double shortest = 1e-7, longest = 1e4;  // [s]
constexpr double width = 0.01;                    // of an interval, as a share of its beginning

std::size_t interval_of(double seconds) {
  return static_cast<std::size_t>(std::log(std::clamp(seconds, shortest, longest) / shortest) / std::log1p(width));
}

}  // namespace

void DurationRecord::add(double seconds) {
  ++count_;
  total_ += seconds;
  maximum_ = std::max(maximum_, seconds);
  if (count_ <= exact_count) {
    values_.push_back(seconds);
    return;
  }
  if (intervals_.empty()) {
    intervals_.resize(interval_of(longest) + 1);
    for (const double value : values_) count_in_interval(value);
    values_ = {};
  }
  count_in_interval(seconds);
}

void DurationRecord::count_in_interval(double seconds) { ++intervals_[interval_of(seconds)]; }

double DurationRecord::value_of_rank(std::uint64_t rank) const {
  std::size_t interval = 0;
  for (std::uint64_t below = intervals_[0]; below <= rank; below += intervals_[interval]) ++interval;
  const double centre = shortest * std::pow(1.0 + width, static_cast<double>(interval) + 0.5);
  return std::min(centre, maximum_);
}

double DurationRecord::percentile(double percent) const {
  if (empty()) return std::numeric_limits<double>::quiet_NaN();
  if (intervals_.empty()) return holdfast::percentile(values_, percent);
  const double rank = std::clamp(percent / 100.0, 0.0, 1.0) * static_cast<double>(count_ - 1);
  if (rank == static_cast<double>(count_ - 1)) return maximum_;
  return value_of_rank(static_cast<std::uint64_t>(std::lround(rank)));
}

}  // namespace holdfast
