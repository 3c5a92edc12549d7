// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

void require_new_files(std::initializer_list<std::filesystem::path> files, bool overwrite) {
  std::error_code ignored;
  for (const std::filesystem::path& file : files) {
    if (overwrite || file.empty() || file == "-" || !std::filesystem::is_regular_file(file, ignored)) continue;
    throw InputError({file.string()}, "is there already; name another file, or add --overwrite");
  }
}

void write_output(const std::string& target, const std::string& content) {
  if (target == "-")
    std::cout << content;
  else
    write_file_atomically(target, content);
}

void add_overwrite_option(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "Replace files that are there");
}

std::string input_name(const std::string& given) { return given == "-" ? "/dev/stdin" : given; }

}  // namespace holdfast
