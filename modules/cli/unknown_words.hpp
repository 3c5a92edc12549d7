// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace holdfast {

/// What is wrong with the names among the arguments, in the order of the arguments: a word where a command should
/// stand, and options that the command does not have, each with the nearest name. Asked before CLI11 parses them, since
/// CLI11 would complain of a missing option first, or only say that a command is required.
std::vector<std::string> unknown_words(const CLI::App& app, const std::vector<std::string>& words);

/// "holdfast map info": the program with the commands that were parsed.
std::string name_of_parsed_command(const CLI::App& app);

}  // namespace holdfast
