// SPDX-License-Identifier: BSD-3-Clause
#include "unknown_words.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The name of the option that a word gives: "--output" of "--output=out", "-o" of "-oout". A number is none.
std::string option_of(const std::string& word) {
  if (word.starts_with("--")) return word.size() > 2 ? word.substr(0, word.find('=')) : "";
  const bool is_short = word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) != 0;
  return is_short ? word.substr(0, 2) : "";
}

/// "did you mean '--output'?", or nothing: a list of all options would say less than `--help`.
std::string suggestion(const std::string& name, const CLI::App& app) {
  const auto nearest = name.starts_with("--") ? nearest_name(name, option_names(app)) : std::nullopt;
  return nearest ? "did you mean '" + *nearest + "'? " : "";
}

}  // namespace

std::vector<std::string> unknown_words(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  std::string name = "holdfast";
  std::vector<std::string> messages;
  bool may_be_command = true;
  for (const std::string& word : words) {
    if (word == "--") break;
    if (const std::string option = option_of(word); !option.empty()) {
      if (command->get_option_no_throw(option) == nullptr)
        messages.push_back("there is no option '" + option + "'; " + suggestion(option, *command) + "see `" + name +
                           " --help`");
      continue;
    }
    const std::vector<std::string> names = command_names(*command);
    if (!may_be_command || names.empty()) continue;
    may_be_command = std::find(names.begin(), names.end(), word) != names.end();
    if (!may_be_command) {
      messages.push_back("there is no command '" + word + "'; " + did_you_mean(word, names));
      break;  // whose options the rest would be is not known
    }
    command = command->get_subcommand(word);
    name += " " + word;
  }
  return messages;
}

std::string name_of_parsed_command(const CLI::App& app) {
  std::string name = "holdfast";
  for (const CLI::App* command = &app; !command->get_subcommands().empty();) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  return name;
}

}  // namespace holdfast
