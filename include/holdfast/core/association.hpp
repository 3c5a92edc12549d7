// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace holdfast {

/// Associates the time stamps of two lists one to one by a greedy nearest-neighbour rule: among all pairs with
/// |a[i] - b[j]| < max_difference, the pair with the smallest difference is taken first, then the smallest among the
/// remaining stamps, and so on. Ties are resolved by the smaller i, then by the smaller j. This is the rule of the TUM
/// RGB-D benchmark's associate script (Sturm et al., IROS 2012) with deterministic ties.
///
/// Returns pairs (i, j), sorted by i. The lists need not be sorted. A stamp that is not finite is never associated.
/// Complexity: O(n log n) for n stamps, for any max_difference [s].
std::vector<std::pair<std::size_t, std::size_t>> associate_stamps(std::span<const double> a, std::span<const double> b,
                                                                  double max_difference);

}  // namespace holdfast
