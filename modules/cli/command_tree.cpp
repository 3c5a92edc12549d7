// SPDX-License-Identifier: BSD-3-Clause
#include "command_tree.hpp"

#include <CLI/CLI.hpp>

namespace holdfast {

namespace {

OptionEntry option_entry(const CLI::Option& option) {
  OptionEntry entry;
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  if (option.get_type_size_max() > 0) entry.value = option.get_type_name();
  // "TEXT:{se3,sim3,none}": CLI11 appends what its validators say.
  if (const std::size_t open = entry.value.find(":{"); open != std::string::npos && entry.value.back() == '}') {
    std::string choice;
    for (const char c : entry.value.substr(open + 2))
      if (c == ',' || c == '}')
        entry.choices.push_back(std::exchange(choice, {}));
      else
        choice += c;
  }
  entry.value = entry.value.substr(0, entry.value.find(':'));
  entry.help = option.get_description();
  return entry;
}

void add_entries(const CLI::App& app, const std::vector<std::string>& path, std::vector<CommandEntry>& entries) {
  CommandEntry entry;
  entry.path = path;
  entry.help = app.get_description();
  entry.explanation = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional())
      entry.arguments.push_back(option->get_required() ? option->get_name() : "[" + option->get_name() + "]");
    else
      entry.options.push_back(option_entry(*option));
  }
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* command : commands) entry.commands.push_back(command->get_name());
  entries.push_back(entry);
  for (const CLI::App* command : commands) {
    std::vector<std::string> below = path;
    below.push_back(command->get_name());
    add_entries(*command, below, entries);
  }
}

}  // namespace

std::string CommandEntry::name() const {
  std::string text;
  for (const std::string& word : path) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<CommandEntry> command_tree(const CLI::App& program) {
  std::vector<CommandEntry> entries;
  add_entries(program, {}, entries);
  return entries;
}

}  // namespace holdfast
