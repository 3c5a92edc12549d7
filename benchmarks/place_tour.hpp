// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {

/// Keyframes of an endless tour, drawn, not seen: landmarks stand in a row, a keyframe sees a window of them, and the
/// window moves on by a fifth of its length each time. Of 1000 descriptors 600 are landmarks, each with 0 to 40 bits
/// flipped (what `orb` shows of one corner in neighbouring keyframes); the other 400 are seen this once. Every second
/// stretch of 50 keyframes goes along a stretch seen before, at a random place of the tour so far.
///
/// Descriptors of images crowd together; independent bits would not. So each is one of 2048 prototypes with 0 to 128 of
/// its bits drawn anew. A revisit shares about a tenth of its descriptors within 32 bits: less than true revisits do.
class PlaceTour {
 public:
  static constexpr int descriptors_per_keyframe = 1000;

  explicit PlaceTour(std::uint64_t seed = 1) : seed_(seed) {
    Random random(seed);
    for (int i = 0; i < 2048; ++i)
      prototypes_.push_back({{random.next(), random.next(), random.next(), random.next()}});
  }

  /// Where on the row of landmarks keyframe `number` stands; twice the same place: the same value.
  std::int64_t place(std::int64_t number) const {
    const std::int64_t stretch = number / 50;
    const std::int64_t within = number % 50;
    if (stretch % 2 == 0) return stretch / 2 * 50 + within;
    Random random = Random(seed_).fork(static_cast<std::uint64_t>(stretch));
    return random.below(static_cast<std::uint32_t>(stretch / 2 + 1)) * 50 + within;
  }

  std::vector<Descriptor256> keyframe(std::int64_t number) const {
    const std::int64_t first = place(number) * (descriptors_per_keyframe / 5);
    Random random = Random(seed_).fork(0x10000000ULL + static_cast<std::uint64_t>(number));
    std::vector<Descriptor256> descriptors;
    descriptors.reserve(descriptors_per_keyframe);
    for (std::int64_t landmark = first; landmark < first + descriptors_per_keyframe; ++landmark) {
      if (random.uniform() < 0.6)
        descriptors.push_back(disturbed(drawn(static_cast<std::uint64_t>(landmark)), random));
      else
        descriptors.push_back(drawn(random.next()));
    }
    return descriptors;
  }

 private:
  Descriptor256 drawn(std::uint64_t number) const {
    Random random = Random(seed_ + 1).fork(number);
    Descriptor256 descriptor = prototypes_[random.below(2048)];
    redraw(descriptor, random.below(129), random);
    return descriptor;
  }
  static Descriptor256 disturbed(const Descriptor256& descriptor, Random& random) {
    Descriptor256 result = descriptor;
    for (std::uint32_t flips = random.below(41); flips > 0; --flips) {
      const std::uint32_t bit = random.below(256);
      result.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
    return result;
  }
  static void redraw(Descriptor256& descriptor, std::uint32_t bits, Random& random) {
    for (; bits > 0; --bits) {
      const std::uint64_t draw = random.next();
      const std::uint64_t bit = draw & 255;
      descriptor.words[bit / 64] ^= (draw >> 63) << (bit % 64);
    }
  }

  std::uint64_t seed_;
  std::vector<Descriptor256> prototypes_;
};

}  // namespace holdfast
