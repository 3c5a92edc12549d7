// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace holdfast {

/// What the commands that work by a configuration and fill a folder have in common.
struct ConfiguredArguments {
  std::string configuration;
  std::vector<std::string> overrides;
  std::filesystem::path output;
  bool overwrite = false;
  bool quiet = false;
};

/// Adds CONFIG and --set to a command. The variables must live as long as it.
void add_configuration_options(CLI::App& command, std::string& configuration, std::vector<std::string>& overrides);

/// Adds CONFIG, --output, --set, --overwrite and --quiet to a command. `arguments` must live as long as it. What is
/// written into the folder, and what earlier content --overwrite replaces, is said in the command's words.
void add_configured_options(CLI::App& command, ConfiguredArguments& arguments,
                            const std::string& output_help = "Folder for the results",
                            const std::string& overwrite_help = "Replace the results of an earlier run in the folder");

}  // namespace holdfast
