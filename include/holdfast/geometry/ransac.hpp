// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "holdfast/core/random.hpp"

namespace holdfast::geometry {

/// Random sample without repetition: `size` numbers below `count`, in the order of drawing; count must be at least
/// size.
template <std::size_t size>
std::array<std::uint32_t, size> sample_without_repeat(Random& random, std::uint32_t count) {
  std::array<std::uint32_t, size> result{};
  for (std::size_t i = 0; i < size;) {
    result[i] = random.below(count);
    bool is_new = true;
    for (std::size_t k = 0; k < i; ++k) is_new = is_new && result[k] != result[i];
    i += is_new;
  }
  return result;
}

/// Number of samples after which one is free of outliers with the given confidence (Fischler and Bolles 1981, section
/// II-B), at most `max_iterations`.
inline int ransac_iterations(double inlier_ratio, int sample_size, double confidence, int max_iterations) {
  const double all_good = std::pow(inlier_ratio, sample_size);
  if (all_good <= 0.0) return max_iterations;
  if (all_good >= 1.0) return 1;
  const double needed = std::log(1.0 - confidence) / std::log1p(-all_good);
  return needed >= max_iterations ? max_iterations : static_cast<int>(std::ceil(needed));
}

}  // namespace holdfast::geometry
