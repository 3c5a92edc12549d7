// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/hamming.hpp"
#include "holdfast/matching/nearest.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Binary descriptors of 256 bits in one block of memory.
using BinaryDescriptors = std::span<const Descriptor>;

/// Hamming distance [bits].
template <>
struct DescriptorTraits<BinaryDescriptors> {
  using Distance = std::uint16_t;
  static std::size_t size(BinaryDescriptors descriptors) { return descriptors.size(); }
  static void distances(BinaryDescriptors queries, std::uint32_t query, BinaryDescriptors references,
                        std::span<const std::uint32_t> candidates, Distance* distances) {
    hamming_distances(queries[query], references.data(), candidates, distances);
  }
};

/// A match of binary descriptors.
using BinaryMatch = Match<std::uint16_t>;

}  // namespace holdfast::matching
