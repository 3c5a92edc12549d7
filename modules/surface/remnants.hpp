// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "blocks.hpp"
#include "holdfast/surface/surface_settings.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast::surface {

/// Removes remnants of what disappeared: connected parts of at most 0.5 m^2 that adjoin carved surface with half of
/// their vertices, and that no view has observed since that was carved.
void remove_remnants(TriangleMesh& mesh, const Blocks& blocks, const SurfaceSettings& settings);

}  // namespace holdfast::surface
