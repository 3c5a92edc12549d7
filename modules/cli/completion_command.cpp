// SPDX-License-Identifier: BSD-3-Clause
#include "completion_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "command_tree.hpp"

namespace holdfast {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// Text for a shell, between single quotes.
std::string quoted_for_shell(const std::string& text) {
  std::string result = "'";
  for (const char c : text)
    if (c == '\'')
      result += "'\\''";
    else
      result += c == '\n' ? ' ' : c;
  return result + "'";
}

/// Shell code, for bash and zsh, that finds the command among the words before the cursor: `command` is its name.
std::string find_command(const std::vector<CommandEntry>& tree) {
  std::string text = "    case \"$command/$word\" in\n";
  for (const CommandEntry& entry : tree) {
    if (entry.path.empty()) continue;
    const std::vector<std::string> above(entry.path.begin(), entry.path.end() - 1);
    text += "      " + quoted_for_shell(joined(above) + "/" + entry.path.back()) +
            ") command=" + quoted_for_shell(entry.name()) + " ;;\n";
  }
  return text + "    esac\n";
}

std::string bash_script(const std::vector<CommandEntry>& tree) {
  std::string text =
      "# Completion of holdfast for bash, as printed by `holdfast completion bash`.\n"
      "_holdfast() {\n"
      "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local command= word commands= options= choices=\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n" +
      find_command(tree) + "  done\n  case \"$command\" in\n";
  for (const CommandEntry& entry : tree) {
    std::vector<std::string> names;
    std::string choices;
    for (const OptionEntry& option : entry.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (!option.choices.empty())
        choices += " [ \"$before\" = " + option.names.back() +
                   " ] && choices=" + quoted_for_shell(joined(option.choices)) + ";";
    }
    text += "    " + quoted_for_shell(entry.name()) + ") commands=" + quoted_for_shell(joined(entry.commands)) +
            " options=" + quoted_for_shell(joined(names)) + ";" + choices + " ;;\n";
  }
  return text +
         "  esac\n"
         "  if [ -n \"$choices\" ]; then\n"
         "    COMPREPLY=($(compgen -W \"$choices\" -- \"$current\"))\n"
         "  elif [[ $current == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  elif [ -n \"$commands\" ]; then\n"
         "    COMPREPLY=($(compgen -W \"$commands\" -- \"$current\"))\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    local IFS=$'\\n'\n"
         "    COMPREPLY=($(compgen -f -- \"$current\"))\n"
         "  fi\n"
         "}\n"
         "complete -F _holdfast holdfast\n";
}

/// "name:help" of zsh's _describe.
std::string described(std::string name, const std::string& help) { return quoted_for_shell((name += ':') += help); }

std::string zsh_script(const std::vector<CommandEntry>& tree) {
  std::string text =
      "#compdef holdfast\n"
      "# Completion of holdfast for zsh, as printed by `holdfast completion zsh`.\n"
      "_holdfast() {\n"
      "  local command= word\n"
      "  local -a commands options\n"
      "  for word in \"${(@)words[2,CURRENT-1]}\"; do\n" +
      find_command(tree) + "  done\n  case \"$command\" in\n";
  for (const CommandEntry& entry : tree) {
    text += "    " + quoted_for_shell(entry.name()) + ")\n      commands=(";
    for (const CommandEntry& below : tree)
      if (below.path.size() == entry.path.size() + 1 &&
          std::equal(entry.path.begin(), entry.path.end(), below.path.begin()))
        (text += ' ') += described(below.path.back(), below.help);
    text += " )\n      options=(";
    for (const OptionEntry& option : entry.options)
      for (const std::string& name : option.names) (text += ' ') += described(name, option.help);
    text += " ) ;;\n";
  }
  return text +
         "  esac\n"
         "  if [[ $PREFIX == -* ]]; then\n"
         "    _describe option options\n"
         "  elif (( ${#commands} )); then\n"
         "    _describe command commands\n"
         "  else\n"
         "    _files\n"
         "  fi\n"
         "}\n"
         "if [ \"$funcstack[1]\" = _holdfast ]; then _holdfast \"$@\"; else compdef _holdfast holdfast; fi\n";
}

/// The text of a single-quoted word of fish, which escapes by a backslash.
std::string quoted_for_fish(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string fish_script(const std::vector<CommandEntry>& tree) {
  std::string text = "# Completion of holdfast for fish, as printed by `holdfast completion fish`.\n";
  for (const CommandEntry& entry : tree) {
    std::string condition = entry.path.empty() ? "__fish_use_subcommand" : "";
    for (const std::string& word : entry.path)
      condition += (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
    std::string none_below = condition;
    if (!entry.path.empty() && !entry.commands.empty())
      none_below += "; and not __fish_seen_subcommand_from " + joined(entry.commands);
    for (const CommandEntry& below : tree)
      if (below.path.size() == entry.path.size() + 1 &&
          std::equal(entry.path.begin(), entry.path.end(), below.path.begin()))
        text += "complete -c holdfast -f -n '" + none_below + "' -a " + below.path.back() + " -d " +
                quoted_for_fish(below.help) + "\n";
    for (const OptionEntry& option : entry.options) {
      text += "complete -c holdfast -n '" + condition + "'";
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.value.empty()) text += " -r";
      if (!option.choices.empty()) text += " -f -a " + quoted_for_fish(joined(option.choices));
      text += " -d " + quoted_for_fish(option.help) + "\n";
    }
  }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app, int& exit_code) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("completion", "Print what completes commands and options in a shell");
  command->footer(
      "\n`cmake --install` installs the three scripts where the shells look for them.\n\n"
      "Examples\n"
      "  source <(holdfast completion bash)\n"
      "  holdfast completion zsh > ~/.zfunc/_holdfast\n"
      "  holdfast completion fish > ~/.config/fish/completions/holdfast.fish");
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([shell, &app, &exit_code] {
    const std::vector<CommandEntry> tree = command_tree(app);
    const std::string script = *shell == "bash"  ? bash_script(tree)
                               : *shell == "zsh" ? zsh_script(tree)
                                                 : fish_script(tree);
    std::fputs(script.c_str(), stdout);
    exit_code = 0;
  });
}

}  // namespace holdfast
