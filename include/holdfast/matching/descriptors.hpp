// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/matching/nearest.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Distances of descriptors of any type, in the unit of their metric.
template <>
struct DescriptorTraits<DescriptorView> {
  using Distance = float;
  static std::size_t size(const DescriptorView& descriptors) { return descriptors.size(); }
  static void distances(const DescriptorView& queries, std::uint32_t query, const DescriptorView& references,
                        std::span<const std::uint32_t> candidates, Distance* distances) {
    descriptor_distances(queries, query, references, candidates, distances);
  }
};

/// A match of descriptors of any type.
using FeatureMatch = Match<float>;

}  // namespace holdfast::matching
