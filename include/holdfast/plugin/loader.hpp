// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// The folders in which load_plugin searches for a name without a folder, in order: the given folders, those of the
/// environment variable HOLDFAST_PLUGIN_PATH (separated by ':'), then the installed plugin folder, which is
/// found from the running program, and the one beside the library that contains the loader.
std::vector<std::filesystem::path> plugin_search_path(const std::vector<std::filesystem::path>& first);

/// Whether load_plugin() would find a file for this name. The file is not opened.
bool can_find_plugin(const std::string& name_or_path, const std::vector<std::filesystem::path>& search_first = {});

/// Loads a shared plugin, registers its modules and returns the absolute path of its file. The prefix "lib" and the
/// suffix ".so" may be omitted in a name without a folder. Throws PluginError if the file is not found (the message
/// lists the folders searched), cannot be loaded, has no entry function, is incompatible with this build (the message
/// names both sides), or registers a module that exists already. Loading a plugin whose modules the registry already
/// holds has no effect. The library stays loaded until the process ends, because modules may outlive registries.
std::filesystem::path load_plugin(Registry& registry, const std::string& name_or_path,
                                  const std::vector<std::filesystem::path>& search_first = {});

}  // namespace holdfast
