// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/class_colours.hpp"

#include <array>
#include <cstdint>

namespace holdfast {

void colour_by_class(TriangleMesh& mesh) {
  using Colour = std::array<std::uint8_t, 3>;
  constexpr Colour background = {200, 200, 200}, unknown = {90, 95, 105};
  constexpr std::array<Colour, 6> classes = {
      {{30, 120, 255}, {200, 0, 200}, {0, 200, 200}, {255, 140, 0}, {120, 220, 120}, {150, 110, 255}}};
  for (MeshVertex& vertex : mesh.vertices) {
    const Colour& colour = vertex.label == 0                           ? background
                           : vertex.label == MeshVertex::unknown_class ? unknown
                                                                       : classes[(vertex.label - 1U) % classes.size()];
    vertex.red = colour[0], vertex.green = colour[1], vertex.blue = colour[2];
  }
}

}  // namespace holdfast
