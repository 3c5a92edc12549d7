// SPDX-License-Identifier: BSD-3-Clause
// The table is computed and not listed: on each face of the cell, segments separate every run of negative corners, and
// segments of neighbouring faces join to closed polygons. As a face decides by its own corners alone, the polygons of
// two cells meet on their common face.
#include "cube_cases.hpp"

#include <utility>

namespace holdfast::surface {

namespace {

constexpr int edge_count = 24;  // by 3 * corner + axis; half of the numbers are used

int edge_between(int a, int b) {
  const int low = a & b, difference = a ^ b;
  return 3 * low + (difference == 4 ? 0 : difference == 2 ? 1 : 2);
}

/// Corners of the six faces, counter-clockwise as seen from outside.
std::array<std::array<int, 4>, 6> make_faces() {
  std::array<std::array<int, 4>, 6> faces{};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int bit = 4 >> axis, next = 4 >> ((axis + 1) % 3), after = 4 >> ((axis + 2) % 3);
      std::array<int, 4> around{0, next, next | after, after};  // counter-clockwise about the axis
      if (side == 0) around = {0, after, next | after, next};
      for (int i = 0; i < 4; ++i)
        faces[static_cast<std::size_t>(2 * axis + side)][static_cast<std::size_t>(i)] =
            around[static_cast<std::size_t>(i)] | (side != 0 ? bit : 0);
    }
  return faces;
}

std::vector<CubeCases::EdgeTriangle> make_case(unsigned negative) {
  static const auto faces = make_faces();
  // The edge that follows an edge on its polygon.
  std::array<int, edge_count> next{};
  next.fill(-1);
  const auto is_negative = [&](int corner) { return ((negative >> corner) & 1U) != 0; };
  for (const auto& face : faces)
    for (int i = 0; i < 4; ++i) {
      const auto at = [&](int k) { return face[static_cast<std::size_t>(k % 4)]; };
      if (is_negative(at(i)) || !is_negative(at(i + 1))) continue;
      // A run of negative corners begins at i + 1; the segment joins the edges before and after it.
      int end = i + 1;
      while (is_negative(at(end + 1))) ++end;
      next[static_cast<std::size_t>(edge_between(at(i), at(i + 1)))] = edge_between(at(end), at(end + 1));
    }
  std::vector<CubeCases::EdgeTriangle> triangles;
  for (int first = 0; first < edge_count; ++first) {
    if (next[static_cast<std::size_t>(first)] < 0) continue;
    std::vector<int> polygon;
    for (int edge = first; next[static_cast<std::size_t>(edge)] >= 0;) {
      polygon.push_back(edge);
      edge = std::exchange(next[static_cast<std::size_t>(edge)], -1);
    }
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      triangles.push_back({static_cast<std::uint8_t>(polygon[0]), static_cast<std::uint8_t>(polygon[i]),
                           static_cast<std::uint8_t>(polygon[i + 1])});
  }
  return triangles;
}

}  // namespace

const std::vector<CubeCases::EdgeTriangle>& CubeCases::triangles(unsigned negative) {
  static const auto table = [] {
    std::array<std::vector<EdgeTriangle>, 256> cases;
    for (unsigned i = 0; i < cases.size(); ++i) cases[i] = make_case(i);
    return cases;
  }();
  return table[negative & 255U];
}

}  // namespace holdfast::surface
