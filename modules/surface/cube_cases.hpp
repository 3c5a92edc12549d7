// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace holdfast::surface {

/// The cases of marching cubes. Corner c of a cell is at ((c >> 2) & 1, (c >> 1) & 1, c & 1) in x, y, z.
/// Edge 3 * corner + axis goes from that corner, whose bit of the axis is 0, along the axis.
class CubeCases {
 public:
  using EdgeTriangle = std::array<std::uint8_t, 3>;

  /// The triangles of a cell by the set of its negative corners (bit c: corner c is negative), counter-clockwise as
  /// seen from the positive side.
  static const std::vector<EdgeTriangle>& triangles(unsigned negative);

  static constexpr int corner_offset(int corner, int axis) { return (corner >> (2 - axis)) & 1; }
};

}  // namespace holdfast::surface
