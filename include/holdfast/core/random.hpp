// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace holdfast {

/// A small random number generator whose results are the same on every machine and with every standard library
/// (SplitMix64; Steele, Lea and Flood 2014). The distributions are implemented here because the standard does not
/// specify the algorithms of its own.
class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in 0 ... count - 1; count must not be 0.
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32); }
  /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Returns an independent generator for one component, identified by `stream`. Adding a component does not change the
  /// random numbers of the others.
  Random fork(std::uint64_t stream) const {
    Random child(state_ ^ (stream * 0xd1342543de82ef95ULL + 0x2545f4914f6cdd1dULL));
    child.next();
    return child;
  }

 private:
  std::uint64_t state_;
};

}  // namespace holdfast
