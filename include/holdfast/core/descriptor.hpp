// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace holdfast {

/// A binary descriptor of 256 bits (Rublee et al. 2011); bit i is bit i % 64 of word i / 64.
struct alignas(32) Descriptor {
  std::array<std::uint64_t, 4> words{};
  friend bool operator==(const Descriptor&, const Descriptor&) = default;
};
static_assert(sizeof(Descriptor) == 32);

/// Number of bits in which two descriptors differ. Loops over many descriptors should use the kernels of hamming.hpp.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (int i = 0; i < 4; ++i) distance += std::popcount(a.words[i] ^ b.words[i]);
  return distance;
}

}  // namespace holdfast
