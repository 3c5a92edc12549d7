// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "holdfast/core/descriptor.hpp"

namespace holdfast {

/// The two nearest of a set of candidates; index -1 where there is none.
struct NearestDescriptors {
  int best_index = -1;
  int best_distance = std::numeric_limits<int>::max();
  int second_index = -1;
  int second_distance = std::numeric_limits<int>::max();
};

/// distances[i] = Hamming distance of query and descriptors[candidates[i]]; run-time dispatch to popcnt where there is
/// one.
void hamming_distances(const Descriptor& query, const Descriptor* descriptors,
                       std::span<const std::uint32_t> candidates, std::uint16_t* distances);

/// The best and the second best of the candidates; of equal ones the first in the list. Indices are positions in
/// `descriptors`.
NearestDescriptors nearest_descriptors(const Descriptor& query, const Descriptor* descriptors,
                                       std::span<const std::uint32_t> candidates);

}  // namespace holdfast
