// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/stamp_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace holdfast {

namespace {

/// A unit of time, and the intervals at which cameras count in it.
struct StampUnit {
  const char* name;
  double per_second;
  double shortest, longest;  ///< intervals, in this unit
};

// 4 to 250 frames per second in the units of common clocks; between them the ticks of video streams and of Windows.
constexpr std::array<StampUnit, 5> long_units = {{{"milliseconds", 1e3, 4.0, 250.0},
                                                  {"ticks of 90 kHz", 9e4, 250.0, 4e3},
                                                  {"microseconds", 1e6, 4e3, 2.5e5},
                                                  {"ticks of 100 ns", 1e7, 2.5e5, 4e6},
                                                  {"nanoseconds", 1e9, 4e6, 2.5e8}}};
constexpr double longest_interval = 5.0;    // s
constexpr double shortest_interval = 2e-4;  // s
constexpr double largest_frame_number = 1e6;

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.6g", value);
  return text;
}

std::vector<double> sorted_and_finite(std::span<const double> stamps) {
  std::vector<double> sorted;
  std::copy_if(stamps.begin(), stamps.end(), std::back_inserter(sorted), [](double s) { return std::isfinite(s); });
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

double median_interval_of_sorted(const std::vector<double>& sorted) {
  if (sorted.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> intervals;
  for (std::size_t i = 1; i < sorted.size(); ++i) intervals.push_back(sorted[i] - sorted[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// "1000", "1e6": powers of ten as people write them.
std::string factor_text(double factor) {
  const int power = static_cast<int>(std::lround(std::log10(factor)));
  return power >= 6 && std::pow(10.0, power) == factor ? "1e" + std::to_string(power) : number(factor);
}

std::string division(const StampUnit& unit) { return "divide them by " + factor_text(unit.per_second); }

}  // namespace

double median_interval(std::span<const double> stamps) { return median_interval_of_sorted(sorted_and_finite(stamps)); }

std::string stamp_magnitude_suspicion(double stamp) {
  // Since 1970: 1e11 milliseconds are of 1973, 1e11 seconds of the year 5138, and so on for the smaller units.
  constexpr double most_seconds = 1e11;
  for (const StampUnit& unit : {long_units[0], long_units[2], long_units[4]})
    if (stamp >= most_seconds * unit.per_second / 1e3 && stamp < most_seconds * unit.per_second)
      return std::string("look like ") + unit.name + ": " + division(unit);
  return "";
}

std::string stamp_unit_suspicion(std::span<const double> stamps) {
  const std::vector<double> sorted = sorted_and_finite(stamps);
  if (sorted.size() < 3) return "";
  const double interval = median_interval_of_sorted(sorted);
  const std::string from_one_to_next = " (" + number(interval) + " from one to the next)";
  const bool are_integers = std::all_of(sorted.begin(), sorted.end(), [](double s) { return s == std::floor(s); });
  const bool may_be_numbers = are_integers && sorted.front() >= 0.0 && sorted.back() < largest_frame_number;
  if (may_be_numbers && interval == 1.0)
    return "look like frame numbers" + from_one_to_next + ": multiply them by the time between two frames";
  if (const std::string unit = stamp_magnitude_suspicion(sorted.front()); !unit.empty()) return unit;
  if (interval > longest_interval || (interval >= long_units[0].shortest && are_integers)) {
    for (const StampUnit& unit : long_units)
      if (interval >= unit.shortest && interval < unit.longest)
        return std::string("look like ") + unit.name +
               (may_be_numbers && &unit == &long_units[0] ? " or frame numbers" : "") + from_one_to_next + ": " +
               division(unit);
    return "";
  }
  for (const double factor : {1e3, 1e6})
    if (interval < shortest_interval && interval * factor >= 0.004 && interval * factor < 0.25)
      return "rise too slowly for seconds" + from_one_to_next + ": multiply them by " + factor_text(factor);
  return "";
}

}  // namespace holdfast
