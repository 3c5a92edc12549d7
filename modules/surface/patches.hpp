// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "blocks.hpp"
#include "holdfast/core/surface_patch.hpp"
#include "holdfast/surface/surface_settings.hpp"

namespace holdfast::surface {

/// The meshes of blocks that may have changed since a version, in the order of the blocks; see SurfaceField::changes().
std::vector<SurfacePatch> changed_patches(const Blocks& blocks, const SurfaceSettings& settings, std::uint64_t since,
                                          int coarseness);

}  // namespace holdfast::surface
