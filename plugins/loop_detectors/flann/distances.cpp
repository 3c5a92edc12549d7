// SPDX-License-Identifier: BSD-3-Clause
#include "distances.hpp"

#include "holdfast/core/simd.hpp"

namespace holdfast::flann_plugin {

namespace {

void row_scalar(const Descriptor& query, const Descriptor* descriptors, std::size_t count, std::uint16_t* distances) {
  for (std::size_t i = 0; i < count; ++i)
    distances[i] = static_cast<std::uint16_t>(hamming_distance(query, descriptors[i]));
}

#if defined(__x86_64__)
#define HOLDFAST_POPCNT __attribute__((target("popcnt")))

HOLDFAST_POPCNT inline int count_bits(const std::uint64_t* a, const std::uint64_t* b) {
  return static_cast<int>(__builtin_popcountll(a[0] ^ b[0]) + __builtin_popcountll(a[1] ^ b[1]) +
                          __builtin_popcountll(a[2] ^ b[2]) + __builtin_popcountll(a[3] ^ b[3]));
}

HOLDFAST_POPCNT int two_popcnt(const Descriptor& a, const Descriptor& b) {
  return count_bits(a.words.data(), b.words.data());
}

HOLDFAST_POPCNT void row_popcnt(const Descriptor& query, const Descriptor* descriptors, std::size_t count,
                                std::uint16_t* distances) {
  const std::uint64_t words[4] = {query.words[0], query.words[1], query.words[2], query.words[3]};
  for (std::size_t i = 0; i < count; ++i)
    distances[i] = static_cast<std::uint16_t>(count_bits(words, descriptors[i].words.data()));
}
#endif

}  // namespace

DistanceKernels distance_kernels() {
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::sse4) return {two_popcnt, row_popcnt};
#endif
  return {hamming_distance, row_scalar};
}

}  // namespace holdfast::flann_plugin
