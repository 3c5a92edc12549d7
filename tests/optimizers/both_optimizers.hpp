// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry& registry);
extern "C" void holdfast_register_plugin_schur(holdfast::Registry& registry);

namespace holdfast {

/// The optimizer `ceres` or `schur`.
inline std::unique_ptr<Optimizer> make_optimizer(const std::string& name, const ParameterValues& values = {}) {
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  holdfast_register_plugin_schur(registry);
  return registry.create<Optimizer>(name, values, {});
}

}  // namespace holdfast
