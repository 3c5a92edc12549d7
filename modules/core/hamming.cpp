// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/hamming.hpp"

#include "holdfast/core/simd.hpp"

namespace holdfast {

namespace {

#if defined(__x86_64__)
#define HOLDFAST_POPCNT __attribute__((target("popcnt")))
HOLDFAST_POPCNT inline int distance_popcnt(const Descriptor& a, const Descriptor& b) {
  return static_cast<int>(
      __builtin_popcountll(a.words[0] ^ b.words[0]) + __builtin_popcountll(a.words[1] ^ b.words[1]) +
      __builtin_popcountll(a.words[2] ^ b.words[2]) + __builtin_popcountll(a.words[3] ^ b.words[3]));
}

HOLDFAST_POPCNT void distances_popcnt(const Descriptor& query, const Descriptor* descriptors,
                                      std::span<const std::uint32_t> candidates, std::uint16_t* distances) {
  for (std::size_t i = 0; i < candidates.size(); ++i)
    distances[i] = static_cast<std::uint16_t>(distance_popcnt(query, descriptors[candidates[i]]));
}
#endif

void distances_scalar(const Descriptor& query, const Descriptor* descriptors, std::span<const std::uint32_t> candidates,
                      std::uint16_t* distances) {
  for (std::size_t i = 0; i < candidates.size(); ++i)
    distances[i] = static_cast<std::uint16_t>(hamming_distance(query, descriptors[candidates[i]]));
}

inline void consider(int index, int distance, NearestDescriptors& nearest) {
  if (distance < nearest.best_distance) {
    nearest.second_index = nearest.best_index;
    nearest.second_distance = nearest.best_distance;
    nearest.best_index = index;
    nearest.best_distance = distance;
  } else if (distance < nearest.second_distance) {
    nearest.second_index = index;
    nearest.second_distance = distance;
  }
}

}  // namespace

void hamming_distances(const Descriptor& query, const Descriptor* descriptors,
                       std::span<const std::uint32_t> candidates, std::uint16_t* distances) {
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::sse4) return distances_popcnt(query, descriptors, candidates, distances);
#endif
  distances_scalar(query, descriptors, candidates, distances);
}

NearestDescriptors nearest_descriptors(const Descriptor& query, const Descriptor* descriptors,
                                       std::span<const std::uint32_t> candidates) {
  constexpr std::size_t block = 64;
  std::uint16_t distances[block];
  NearestDescriptors nearest;
  for (std::size_t begin = 0; begin < candidates.size(); begin += block) {
    const auto part = candidates.subspan(begin, std::min(block, candidates.size() - begin));
    hamming_distances(query, descriptors, part, distances);
    for (std::size_t i = 0; i < part.size(); ++i) consider(static_cast<int>(part[i]), distances[i], nearest);
  }
  return nearest;
}

}  // namespace holdfast
