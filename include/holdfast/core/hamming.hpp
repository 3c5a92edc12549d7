// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/simd.hpp"

namespace holdfast {

namespace detail {

#if defined(__x86_64__)
__attribute__((target("popcnt"))) inline int distance_popcnt(const Descriptor& a, const Descriptor& b) {
  return static_cast<int>(
      __builtin_popcountll(a.words[0] ^ b.words[0]) + __builtin_popcountll(a.words[1] ^ b.words[1]) +
      __builtin_popcountll(a.words[2] ^ b.words[2]) + __builtin_popcountll(a.words[3] ^ b.words[3]));
}

__attribute__((target("popcnt"))) inline void distances_popcnt(const Descriptor& query, const Descriptor* descriptors,
                                                               std::span<const std::uint32_t> candidates,
                                                               std::uint16_t* distances) {
  for (std::size_t i = 0; i < candidates.size(); ++i)
    distances[i] = static_cast<std::uint16_t>(distance_popcnt(query, descriptors[candidates[i]]));
}
#endif

inline void distances_scalar(const Descriptor& query, const Descriptor* descriptors,
                             std::span<const std::uint32_t> candidates, std::uint16_t* distances) {
  for (std::size_t i = 0; i < candidates.size(); ++i)
    distances[i] = static_cast<std::uint16_t>(hamming_distance(query, descriptors[candidates[i]]));
}

}  // namespace detail

/// distances[i] = Hamming distance between the query and descriptors[candidates[i]]. Uses the popcnt instruction if the
/// processor has it (run-time dispatch).
inline void hamming_distances(const Descriptor& query, const Descriptor* descriptors,
                              std::span<const std::uint32_t> candidates, std::uint16_t* distances) {
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::sse4) return detail::distances_popcnt(query, descriptors, candidates, distances);
#endif
  detail::distances_scalar(query, descriptors, candidates, distances);
}

}  // namespace holdfast
