// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// Folders of YAML files that are installed with the program.
enum class InstalledFolder { configurations, scenes };

/// Names without ".yaml" of the files in an installed folder, sorted; empty where the folder is missing.
std::vector<std::string> installed_names(InstalledFolder folder);

/// The file that an argument names: standard input for "-"; the argument itself if there is such a file or if it has a
/// folder; otherwise the installed file of this name, with or without ".yaml". Throws ConfigurationError for a plain
/// name, without folder and ending, that is neither. Any other argument is returned as it is.
std::string find_file(const std::string& argument, InstalledFolder folder);

}  // namespace holdfast
