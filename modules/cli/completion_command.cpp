// SPDX-License-Identifier: BSD-3-Clause
#include "completion_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "command_tree.hpp"
#include "completion_words.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

const std::map<std::string, CompletionWords>& word_kinds() {
  static const std::map<std::string, CompletionWords> kinds = {{"settings", CompletionWords::settings},
                                                               {"modules", CompletionWords::modules},
                                                               {"configurations", CompletionWords::configurations},
                                                               {"scenes", CompletionWords::scenes}};
  return kinds;
}

/// The kind of words that a command's argument may be, beside files; "" for none.
std::string kind_of_argument(const CommandEntry& entry) {
  const auto has = [&](const std::string& name) {
    return std::any_of(entry.arguments.begin(), entry.arguments.end(),
                       [&](const std::string& argument) { return argument == name || argument == "[" + name + "]"; });
  };
  if (has("CONFIG")) return "configurations";
  if (has("SCENE")) return "scenes";
  return entry.name() == "modules" ? "modules" : "";
}

/// Whether --set of this command sets values of a configuration.
bool sets_configuration(const CommandEntry& entry) {
  return kind_of_argument(entry) != "scenes" &&
         std::any_of(entry.options.begin(), entry.options.end(), [](const OptionEntry& option) {
           return std::find(option.names.begin(), option.names.end(), "--set") != option.names.end();
         });
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

/// Completes the value of --set part by part. Where "=" separates words, as it does by default, bash passes a key and
/// its value as words of their own.
constexpr const char* bash_settings = R"(_holdfast_settings() {
  local setting=$1 kept=$2 word rest
  for word in $("${COMP_WORDS[0]}" completion --words settings 2>/dev/null); do
    [[ $word == "$setting"* ]] || continue
    rest=${word#"$setting"}
    if [[ $setting != *=* ]]; then
      case $rest in
        *[.=]*) word=$setting${rest%%[.=]*}; rest=${rest#"${rest%%[.=]*}"}; word+=${rest:0:1} ;;
      esac
    fi
    word=${word#"$kept"}
    [[ " ${COMPREPLY[*]} " == *" $word "* ]] || COMPREPLY+=("$word")
  done
  if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[.=[] ]]; then compopt -o nospace 2>/dev/null; fi
}
)";

std::string bash_script(const std::vector<CommandEntry>& tree) {
  std::string text = "# Completion of holdfast for bash, as printed by `holdfast completion bash`.\n" +
                     std::string(bash_settings) +
                     "_holdfast() {\n"
                     "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} IFS=$' \\t\\n'\n"
                     "  local command= word commands= options= choices= words= settings=\n"
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
            " options=" + quoted_for_shell(joined(names)) + ";" + choices;
    if (const std::string kind = kind_of_argument(entry); !kind.empty()) text += " words=" + kind + ";";
    if (sets_configuration(entry)) text += " settings=yes;";
    text += " ;;\n";
  }
  return text +
         "  esac\n"
         "  COMPREPLY=()\n"
         "  if [ -n \"$settings\" ] && [ \"$before\" = --set ]; then\n"
         "    _holdfast_settings \"$current\" ''\n"
         "  elif [ -n \"$settings\" ] && ((COMP_CWORD > 2)) && [ \"$current\" = = ] &&\n"
         "    [ \"${COMP_WORDS[COMP_CWORD-2]}\" = --set ]; then\n"
         "    _holdfast_settings \"$before=\" \"$before=\"\n"
         "  elif [ -n \"$settings\" ] && ((COMP_CWORD > 3)) && [ \"$before\" = = ] &&\n"
         "    [ \"${COMP_WORDS[COMP_CWORD-3]}\" = --set ]; then\n"
         "    _holdfast_settings \"${COMP_WORDS[COMP_CWORD-2]}=$current\" \"${COMP_WORDS[COMP_CWORD-2]}=\"\n"
         "  elif [ -n \"$choices\" ]; then\n"
         "    COMPREPLY=($(compgen -W \"$choices\" -- \"$current\"))\n"
         "  elif [[ $current == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  elif [ -n \"$commands\" ]; then\n"
         "    COMPREPLY=($(compgen -W \"$commands\" -- \"$current\"))\n"
         "  elif [ \"$words\" = modules ] && [[ $before != -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$(\"${COMP_WORDS[0]}\" completion --words modules 2>/dev/null)\" -- "
         "\"$current\"))\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    if [ -n \"$words\" ] && [[ $before != -* && $current != */* ]]; then\n"
         "      COMPREPLY=($(compgen -W \"$(\"${COMP_WORDS[0]}\" completion --words \"$words\" 2>/dev/null)\" -- "
         "\"$current\"))\n"
         "    fi\n"
         "    local IFS=$'\\n'\n"
         "    COMPREPLY+=($(compgen -f -- \"$current\"))\n"
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
      "  local command= word words_of= settings=\n"
      "  local -a commands options more\n"
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
    text += " )\n      words_of=" + quoted_for_shell(kind_of_argument(entry)) +
            " settings=" + (sets_configuration(entry) ? "yes" : "''") + " ;;\n";
  }
  return text +
         "  esac\n"
         "  if [[ -n $settings && $words[CURRENT-1] == --set ]]; then\n"
         "    more=(${(f)\"$($words[1] completion --words settings 2>/dev/null)\"})\n"
         "    compadd -S '' -a more\n"
         "  elif [[ $PREFIX == -* ]]; then\n"
         "    _describe option options\n"
         "  elif (( ${#commands} )); then\n"
         "    _describe command commands\n"
         "  else\n"
         "    if [[ -n $words_of && $words[CURRENT-1] != -* ]]; then\n"
         "      more=(${(f)\"$($words[1] completion --words $words_of 2>/dev/null)\"})\n"
         "      compadd -a more\n"
         "    fi\n"
         "    [[ $words_of == modules ]] || _files\n"
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
  std::string text =
      "# Completion of holdfast for fish, as printed by `holdfast completion fish`.\n"
      "function __holdfast_words\n  set -l words (commandline -opc)\n"
      "  command $words[1] completion --words $argv[1] 2>/dev/null\nend\n";
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
    if (const std::string kind = kind_of_argument(entry); !kind.empty())
      text += "complete -c holdfast" + std::string(kind == "modules" ? " -f" : "") + " -n '" + condition +
              "' -a '(__holdfast_words " + kind + ")'\n";
    for (const OptionEntry& option : entry.options) {
      text += "complete -c holdfast -n '" + condition + "'";
      for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.value.empty()) text += " -r";
      if (!option.choices.empty()) text += " -f -a " + quoted_for_fish(joined(option.choices));
      if (option.names.back() == "--set" && sets_configuration(entry)) text += " -f -a '(__holdfast_words settings)'";
      text += " -d " + quoted_for_fish(option.help) + "\n";
    }
  }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  const auto shell = std::make_shared<std::string>(), words = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("completion", "Print what completes commands, options and settings in a shell");
  command->footer(
      "\n`cmake --install` installs the three scripts where the shells look for them. Commands, options, names of\n"
      "modules and of installed configurations, and what follows --set are completed.\n\n"
      "Examples\n"
      "  source <(holdfast completion bash)\n"
      "  holdfast completion zsh > ~/.zfunc/_holdfast\n"
      "  holdfast completion fish > ~/.config/fish/completions/holdfast.fish");
  command->add_option("SHELL", *shell, "bash, zsh or fish")->check(CLI::IsMember({"bash", "zsh", "fish"}));
  std::vector<std::string> kinds;
  for (const auto& [name, kind] : word_kinds()) kinds.push_back(name);
  command->add_option("--words", *words, "Print words of this kind, one a line; the scripts ask for them")
      ->type_name("KIND")
      ->check(CLI::IsMember(kinds));
  command->callback([shell, words, &app, &exit_code, host] {
    exit_code = 0;
    if (!words->empty()) {
      for (const std::string& word : completion_words(word_kinds().at(*words), host.modules()))
        std::printf("%s\n", word.c_str());
      return;
    }
    if (shell->empty()) throw UsageError("SHELL is required: bash, zsh or fish");
    const std::vector<CommandEntry> tree = command_tree(app);
    const std::string script = *shell == "bash"  ? bash_script(tree)
                               : *shell == "zsh" ? zsh_script(tree)
                                                 : fish_script(tree);
    std::fputs(script.c_str(), stdout);
  });
}

}  // namespace holdfast
