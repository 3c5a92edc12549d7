// SPDX-License-Identifier: BSD-3-Clause
#include "manual_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>

#include "command_tree.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast {

namespace {

/// Text for troff: backslashes and hyphens are written out, and no line begins with a control character.
std::string escaped(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins_line = i == 0 || text[i - 1] == '\n';
    if (begins_line && (text[i] == '.' || text[i] == '\'')) result += "\\&";
    if (text[i] == '\\')
      result += "\\e";
    else if (text[i] == '-')
      result += "\\-";
    else
      result += text[i];
  }
  return result;
}

std::string synopsis(const CommandEntry& entry) {
  std::string text = ".B holdfast " + escaped(entry.name()) + "\n";
  for (const std::string& argument : entry.arguments) text += ".I " + escaped(argument) + "\n";
  if (entry.path.empty()) text += ".I COMMAND\n";
  return text + "[options]\n";
}

std::string option_text(const OptionEntry& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "\\fB" : ", \\fB") + escaped(name) + "\\fR";
  if (!option.value.empty()) names += " \\fI" + escaped(option.value) + "\\fR";
  std::string text = ".TP\n" + names + "\n" + escaped(option.help);
  for (std::size_t i = 0; i < option.choices.size(); ++i)
    text += (i == 0 ? "; one of " : ", ") + escaped(option.choices[i]);
  return text + "\n";
}

std::string manual(const std::vector<CommandEntry>& tree) {
  std::string text = ".TH HOLDFAST 1 \"\" \"holdfast " HOLDFAST_VERSION "\" \"User Commands\"\n.SH NAME\n";
  text += "holdfast \\- visual SLAM for rooms where people move\n.SH SYNOPSIS\n" + synopsis(tree.front());
  text += ".SH DESCRIPTION\n.nf\n" + escaped(tree.front().help) + "\n.fi\n.SH OPTIONS\n";
  for (const OptionEntry& option : tree.front().options) text += option_text(option);
  text += ".SH COMMANDS\n";
  for (const CommandEntry& entry : tree) {
    if (entry.path.empty()) continue;
    text += ".SS holdfast " + escaped(entry.name()) + "\n" + escaped(entry.help) + ".\n.PP\n" + synopsis(entry);
    for (const OptionEntry& option : entry.options) text += option_text(option);
    if (!entry.explanation.empty()) text += ".PP\n.nf\n" + escaped(entry.explanation) + "\n.fi\n";
  }
  return text +
         ".SH EXIT STATUS\n0: done. 1: an error. 2: arguments or a configuration are wrong. 3: a run that\n"
         "\\fB\\-\\-strict\\fR refuses. 130, 143: stopped by a signal.\n";
}

}  // namespace

void add_manual_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("manual", "Print the manual page of all commands");
  command->footer("\n`cmake --install` installs it for `man holdfast`.\n\nExamples\n  holdfast manual | man -l -");
  command->callback([&app, &exit_code] {
    std::fputs(manual(command_tree(app)).c_str(), stdout);
    exit_code = 0;
  });
}

}  // namespace holdfast
