// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "blocks.hpp"
#include "holdfast/surface/surface_field.hpp"

namespace holdfast::surface {

/// See SurfaceField::sample(). `point` in voxels.
std::optional<SurfaceField::Sample> sample(const Blocks& blocks, const SurfaceSettings& settings,
                                           const Eigen::Vector3f& point);

}  // namespace holdfast::surface
