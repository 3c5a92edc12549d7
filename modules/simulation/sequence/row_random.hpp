// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/random.hpp"
#include "rendering/vectors.hpp"

namespace holdfast::simulation {

/// Random bits for noise on a row of pixels, four words at once (xorshift; Marsaglia 2003, in four independent lanes).
class RowRandom {
 public:
  explicit RowRandom(Random random) {
    for (int lane = 0; lane < 4; ++lane) state_[lane] = static_cast<std::uint32_t>(random.next() >> 32) | 1U;
  }

  Words4 next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }

 private:
  Words4 state_;
};

/// Four nearly normal numbers with mean 0, as integers: the sum of the four bytes of each word less its mean (see
/// quick_normal). Their standard deviation is byte_sum_deviation.
inline Integers4 byte_sums(Words4 bits) {
  const Words4 pairs = (bits & 0x00ff00ffU) + ((bits >> 8) & 0x00ff00ffU);
  return reinterpret_cast<Integers4>((pairs & 0xffffU) + (pairs >> 16)) - 510;
}
inline constexpr float byte_sum_deviation = 147.8005F;

}  // namespace holdfast::simulation
