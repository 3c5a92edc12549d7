// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace holdfast {

/// Pairs stamps of two lists one to one, nearest first: of all pairs whose difference is smaller than max_difference
/// (strictly) the one with the smallest |a[i] - b[j]| is taken, then the smallest among the stamps that are left, and
/// so on; of equally near pairs the one with the smaller i counts, then the one with the smaller j. This is the rule of
/// the TUM RGB-D benchmark's associate script (Sturm et al., IROS 2012), with its ties made definite.
///
/// Returns pairs (i, j), sorted by i. The lists need not be sorted. A stamp that is not finite pairs with nothing.
/// Takes O(n log n) for n stamps, whatever max_difference is [s].
std::vector<std::pair<std::size_t, std::size_t>> associate_stamps(std::span<const double> a, std::span<const double> b,
                                                                  double max_difference);

}  // namespace holdfast
