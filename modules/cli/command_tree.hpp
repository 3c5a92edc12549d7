// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace holdfast {

/// An option as help, completion and manual show it.
struct OptionEntry {
  std::vector<std::string> names;  ///< "-o", "--output"
  std::string value;               ///< what stands for its value, such as "FILE"; empty for a flag
  std::string help;
  std::vector<std::string> choices;  ///< the values that it takes; empty = any
};

/// A command of the program with its options. The first entry is the program itself, with an empty path.
struct CommandEntry {
  std::vector<std::string> path;       ///< {"map", "info"}
  std::vector<std::string> arguments;  ///< "CONFIG", without options
  std::string help;
  std::string explanation;  ///< what help prints below the options
  std::vector<OptionEntry> options;
  std::vector<std::string> commands;  ///< names of the commands below it

  /// "map info".
  std::string name() const;
};

/// All commands in the order in which help lists them, each before those below it.
std::vector<CommandEntry> command_tree(const CLI::App& program);

}  // namespace holdfast
