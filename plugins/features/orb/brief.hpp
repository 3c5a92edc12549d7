// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace holdfast::orb_plugin {

/// One binary test: bit = grey(x1, y1) < grey(x2, y2), in pixels from the feature, unrotated.
struct BriefTest {
  std::int8_t x1, y1, x2, y2;
};

/// No sample is farther from the feature than this [px], rotated or not.
inline constexpr int brief_radius = 16;

/// The 256 tests (pattern.inl; training/README.md says how they were chosen).
const std::array<BriefTest, 256>& brief_pattern();

/// The pattern turned to every one of `steps` directions, as offsets into images of one stride (steered BRIEF, Rublee
/// et al. 2011, section 4.1; the paper's steps are of 12 degrees; finer ones give a few per cent more matches).
class SteeredPattern {
 public:
  static constexpr int steps = 128;

  /// Computes the table unless it is of that stride already.
  void build(std::ptrdiff_t stride);
  /// 512 offsets: the first samples of all tests, then the second ones.
  const std::int32_t* offsets(float angle) const;

 private:
  std::ptrdiff_t stride_ = 0;
  std::vector<std::int32_t> offsets_;
};

}  // namespace holdfast::orb_plugin
