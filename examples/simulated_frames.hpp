// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "holdfast/holdfast.hpp"

/// Stands for a camera, so that the examples need none: a walk through the simulated office.
inline std::unique_ptr<holdfast::FrameSource> simulated_frames(double seconds) {
  holdfast::Registry registry;
  holdfast::register_builtin_plugins(registry);
  return registry.create<holdfast::FrameSource>("simulated", {{"path", "xyz"}, {"duration", seconds}}, {});
}
