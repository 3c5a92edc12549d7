// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Finds a module that a configuration or a program names. An unknown name is appended to `diagnostics` with the given
/// place and the nearest known name; the result is nullptr then. For a module that this build cannot make the reason is
/// appended.
const ModuleEntry* find_module(const Registry& registry, const std::string& kind, const std::string& name,
                               const SourceLocation& place, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
