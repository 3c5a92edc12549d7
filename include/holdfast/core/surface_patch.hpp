// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "holdfast/core/mesh_vertex.hpp"

namespace holdfast {

/// The part of a surface in one cube of space, as an indexed triangle mesh of its own: vertices on the border are those
/// of the neighbouring parts again. The corners of a triangle are counter-clockwise as seen from free space.
struct SurfacePatch {
  Eigen::Vector3i cube = Eigen::Vector3i::Zero();  ///< identifies the cube; a later patch of it replaces this one
  std::vector<MeshVertex> vertices;
  std::vector<std::array<std::uint16_t, 3>> triangles;  ///< empty: there is no surface (any more)
};

}  // namespace holdfast
