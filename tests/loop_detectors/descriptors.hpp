// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::test {

inline Descriptor256 random_descriptor(Random& random) {
  return {{random.next(), random.next(), random.next(), random.next()}};
}

inline std::vector<Descriptor256> random_descriptors(Random& random, int count) {
  std::vector<Descriptor256> descriptors;
  for (int i = 0; i < count; ++i) descriptors.push_back(random_descriptor(random));
  return descriptors;
}

/// With `flips` draws of a bit to flip; a bit drawn twice flips back.
inline Descriptor256 disturbed(const Descriptor256& original, int flips, Random& random) {
  Descriptor256 descriptor = original;
  for (int i = 0; i < flips; ++i) {
    const std::uint32_t bit = random.below(256);
    descriptor.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

/// A place seen again: a share of its descriptors with flipped bits, the rest of something new.
inline std::vector<Descriptor256> seen_again(const std::vector<Descriptor256>& place, double share, int flips,
                                             Random& random) {
  std::vector<Descriptor256> view;
  for (const Descriptor256& descriptor : place)
    view.push_back(random.uniform() < share ? disturbed(descriptor, flips, random) : random_descriptor(random));
  return view;
}

}  // namespace holdfast::test
