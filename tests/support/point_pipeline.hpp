// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry& registry);

namespace holdfast::test {

/// Parts of a pipeline that sees a world of points, with noise of 0.3 px. The world must outlive the pipeline.
inline PipelineParts point_parts(PointWorld& world) {
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  PipelineParts parts;
  parts.camera = world.camera();
  parts.features = std::make_unique<PointExtractor>(world, 0.3);
  parts.optimizer = registry.create<Optimizer>("ceres", {}, {});
  return parts;
}

}  // namespace holdfast::test
