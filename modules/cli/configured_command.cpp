// SPDX-License-Identifier: BSD-3-Clause
#include "configured_command.hpp"

#include <CLI/CLI.hpp>

namespace holdfast {

void add_configured_options(CLI::App& command, ConfiguredArguments& arguments, const std::string& output_help,
                            const std::string& overwrite_help) {
  command.add_option("CONFIG", arguments.configuration, "Configuration in YAML")->required();
  command.add_option("--output", arguments.output, output_help)->required();
  command.add_option("--set", arguments.overrides, "key.path=value: as if the file said so; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--overwrite", arguments.overwrite, overwrite_help);
  command.add_flag("--quiet", arguments.quiet, "No progress, no summary");
}

}  // namespace holdfast
