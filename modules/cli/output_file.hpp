// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace CLI {
class App;
}

namespace holdfast {

/// Throws InputError when one of the files is there and may not be replaced. Asked before the work, so that none is
/// lost. "" and "-" (standard output) are no files.
void require_new_files(std::initializer_list<std::filesystem::path> files, bool overwrite);

/// Writes a file in one step, or to standard output when `target` is "-".
void write_output(const std::string& target, const std::string& content);

/// Adds --overwrite for commands that write single files.
void add_overwrite_option(CLI::App& command, bool& overwrite);

/// What a command reads by the name that a user gives: "-" is standard input.
std::string input_name(const std::string& given);

}  // namespace holdfast
