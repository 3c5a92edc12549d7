// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Reduces a mesh to at most `target` triangles by edge collapses in the order of their quadric error, weighted by area
/// (Garland and Heckbert, SIGGRAPH 1997). Boundaries are kept by planes perpendicular to them. Collapses that would
/// turn the normal of a triangle by more than 78 degrees or change the topology are refused, so that more than `target`
/// triangles may remain. Normals and colours are interpolated along the collapsed edges. Deterministic; about 0.4 kB of
/// memory per triangle.
void decimate(TriangleMesh& mesh, std::size_t target);

}  // namespace holdfast
