// SPDX-License-Identifier: BSD-3-Clause
#include "configured_command.hpp"

#include <CLI/CLI.hpp>

#include "installed_files.hpp"

namespace holdfast {

void add_configuration_options(CLI::App& command, std::string& configuration, std::vector<std::string>& overrides) {
  command
      .add_option("CONFIG", configuration,
                  "Configuration in YAML, or the name of an installed one, such as demo; '-': standard input")
      ->required()
      ->transform([](const std::string& given) { return find_file(given, InstalledFolder::configurations); });
  command.add_option("--set", overrides, "key.path=value: as if the file said so; may be repeated")
      ->allow_extra_args(false);
}

void add_configured_options(CLI::App& command, ConfiguredArguments& arguments, const std::string& output_help,
                            const std::string& overwrite_help) {
  add_configuration_options(command, arguments.configuration, arguments.overrides);
  command.add_option("-o,--output", arguments.output, output_help)->required();
  command.add_flag("--overwrite", arguments.overwrite, overwrite_help);
  command.add_flag("-q,--quiet", arguments.quiet, "No progress, no summary");
}

}  // namespace holdfast
