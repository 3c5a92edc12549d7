// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "holdfast/core/surface_patch.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Divides a mesh into patches of at most 10,000 triangles, for the viewer: the triangles whose first corner is in the
/// same cube of side 1 m, in several patches with the same SurfacePatch::cube if there are more.
std::vector<SurfacePatch> patches_of(const TriangleMesh& mesh);

}  // namespace holdfast
