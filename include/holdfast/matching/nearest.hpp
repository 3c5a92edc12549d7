// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Match of a query (a point or a feature) with a reference, by the caller's indices.
template <class Distance>
struct Match {
  std::uint32_t source = 0;   ///< index of the point or query
  std::uint32_t feature = 0;  ///< index of the feature or reference
  Distance distance = 0;      ///< of their descriptors
};

/// The nearest and the second nearest of a set of candidates.
template <class Distance>
struct NearestTwo {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t best = none, second = none;
  Distance best_distance = std::numeric_limits<Distance>::max();
  Distance second_distance = std::numeric_limits<Distance>::max();

  bool has_best() const { return best != none; }
  bool has_second() const { return second != none; }
};

/// Finds the two smallest distances; ties are resolved by the order of the list. distances[k] belongs to candidates[k].
template <class Distance>
NearestTwo<Distance> nearest_two(std::span<const std::uint32_t> candidates, const Distance* distances) {
  NearestTwo<Distance> nearest;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (distances[k] < nearest.best_distance) {
      nearest.second_distance = nearest.best_distance, nearest.second = nearest.best;
      nearest.best_distance = distances[k], nearest.best = candidates[k];
    } else if (distances[k] < nearest.second_distance) {
      nearest.second_distance = distances[k], nearest.second = candidates[k];
    }
  }
  return nearest;
}

/// Compares one query with all candidates and writes the distances to `distances`.
template <DescriptorSet Descriptors>
NearestTwo<DistanceOf<Descriptors>> nearest_two(const Descriptors& queries, std::uint32_t query,
                                                const Descriptors& references,
                                                std::span<const std::uint32_t> candidates,
                                                std::vector<DistanceOf<Descriptors>>& distances) {
  distances.resize(candidates.size());
  DescriptorTraits<Descriptors>::distances(queries, query, references, candidates, distances.data());
  return nearest_two(candidates, distances.data());
}

}  // namespace holdfast::matching
