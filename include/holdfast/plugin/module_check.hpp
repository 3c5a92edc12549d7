// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Finds a module by name. For an unknown name, returns nullptr and appends an error with the given location and the
/// nearest known name to `diagnostics`. For a module that is not usable in this build the reason is appended.
const ModuleEntry* find_module(const Registry& registry, const std::string& kind, const std::string& name,
                               const SourceLocation& place, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
