// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// Where load_plugin looks for a name without a folder, in this order: the given folders, those of the environment
/// variable HOLDFAST_PLUGIN_PATH (separated by ':'), then the installed plugin folder.
std::vector<std::filesystem::path> plugin_search_path(const std::vector<std::filesystem::path>& first);

/// Loads a shared plugin and lets it register its modules. Throws PluginError when the file is not found (naming the
/// folders searched), cannot be loaded, has no entry, does not fit this build (naming both sides), or names a module
/// that exists already. Returns the file, absolute. The library stays loaded until the process ends: modules and their
/// code may outlive registries.
std::filesystem::path load_plugin(Registry& registry, const std::string& name_or_path,
                                  const std::vector<std::filesystem::path>& search_first = {});

}  // namespace holdfast
