// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace holdfast::orb_plugin {

/// Where between the pixels the corner score peaks.
struct SubpixelOffset {
  float x = 0, y = 0;
};

/// Peak of the quadratic that fits nine scores (3 x 3, row by row) best in the sense of least squares, relative to the
/// middle one [px]; clamped to 0.75, and 0 where the scores have no peak.
SubpixelOffset score_peak(const std::array<std::uint8_t, 9>& scores);

}  // namespace holdfast::orb_plugin
