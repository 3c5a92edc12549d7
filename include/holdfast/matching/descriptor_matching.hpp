// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "holdfast/matching/nearest.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Settings of descriptor matching.
struct DescriptorMatchingSettings {
  float max_distance = 50.0F;  ///< of the descriptors, in their unit (bits for binary ones)
  /// Ratio test (Lowe 2004, section 7.1): maximum ratio of the smallest distance to that of any rival. 1 = no test.
  float ratio = 0.8F;
  /// Mutual nearest neighbours: the query must also be the nearest of all queries to its reference. Otherwise a
  /// reference that is the nearest of several queries is matched with the nearest of these, the first of equal ones.
  bool mutual = false;
};

/// Default of `is_rival`: the ratio test compares with every other reference.
struct EveryReference {
  bool operator()(std::uint32_t, std::uint32_t) const { return true; }
};

/// Compares every query with every reference. An object keeps its buffers between calls and serves one thread.
template <DescriptorSet Descriptors>
class DescriptorMatcher {
 public:
  using Distance = DistanceOf<Descriptors>;
  using FoundMatch = Match<Distance>;

  /// A subset of a set of descriptors.
  struct Selection {
    Descriptors descriptors;
    std::span<const std::uint32_t> indices;
  };

  /// Matches queries (Match::source) with references (Match::feature), each of either at most once. The matches are
  /// ordered by reference and valid until the next call. `is_rival(nearest, other)` restricts the second-nearest
  /// candidates of the ratio test, for instance to exclude duplicates of the nearest map point.
  template <class IsRival = EveryReference>
  const std::vector<FoundMatch>& match(const Selection& queries, const Selection& references,
                                       const DescriptorMatchingSettings& settings, IsRival&& is_rival = {}) {
    const std::size_t reference_count = DescriptorTraits<Descriptors>::size(references.descriptors);
    best_of_reference_.assign(reference_count, FoundMatch{0, 0, unmatched});
    for (const std::uint32_t query : queries.indices) {
      const NearestTwo<Distance> nearest =
          nearest_two(queries.descriptors, query, references.descriptors, references.indices, distances_);
      if (!nearest.has_best() || static_cast<float>(nearest.best_distance) > settings.max_distance) continue;
      FoundMatch& kept = best_of_reference_[nearest.best];
      if (nearest.best_distance >= kept.distance || has_rival(nearest, references.indices, settings.ratio, is_rival))
        continue;
      if (settings.mutual &&
          nearest_two(references.descriptors, nearest.best, queries.descriptors, queries.indices, distances_).best !=
              query)
        continue;
      kept = {query, nearest.best, nearest.best_distance};
    }
    matches_.clear();
    for (const FoundMatch& match : best_of_reference_)
      if (match.distance != unmatched) matches_.push_back(match);
    return matches_;
  }

 private:
  static constexpr Distance unmatched = std::numeric_limits<Distance>::max();

  template <class IsRival>
  bool has_rival(const NearestTwo<Distance>& nearest, std::span<const std::uint32_t> references, float ratio,
                 IsRival& is_rival) const {
    const auto distance = static_cast<float>(nearest.best_distance);
    for (std::size_t k = 0; k < references.size(); ++k)
      if (references[k] != nearest.best && distance > ratio * static_cast<float>(distances_[k]) &&
          is_rival(nearest.best, references[k]))
        return true;
    return false;
  }

  std::vector<Distance> distances_;
  std::vector<FoundMatch> best_of_reference_;
  std::vector<FoundMatch> matches_;
};

}  // namespace holdfast::matching
