// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast::surface {

/// Marching cubes over all cells whose eight corners have a value (Block::value), without normals.
TriangleMesh march(const Blocks& blocks, double voxel, int minimum_views);

}  // namespace holdfast::surface
