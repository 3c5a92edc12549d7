// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace holdfast {

/// Two stamps that belong together, by their place in each list.
struct StampPair {
  std::size_t first = 0;
  std::size_t second = 0;

  friend bool operator==(const StampPair&, const StampPair&) = default;
};

/// Pairs two sorted lists of stamps [s] one-to-one: of all pairs closer than `max_difference` (strictly) the closest is
/// taken first, then the closest of what is left; equal distances in the order of the stamps. This is the association
/// of the TUM RGB-D benchmark (Sturm et al. 2012). The result is sorted by `first`.
std::vector<StampPair> pair_stamps(std::span<const double> first, std::span<const double> second,
                                   double max_difference);

/// Place of the stamp nearest to `time` in a sorted list; of two equally near ones the earlier. The list must not be
/// empty.
std::size_t nearest_stamp(std::span<const double> sorted, double time);

}  // namespace holdfast
