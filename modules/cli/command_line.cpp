// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "background_command.hpp"
#include "bench_command.hpp"
#include "calibrate_command.hpp"
#include "check_command.hpp"
#include "completion_command.hpp"
#include "dataset_command.hpp"
#include "evaluate_command.hpp"
#include "evaluate_segmentation_command.hpp"
#include "evaluate_surface_command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/system_reason.hpp"
#include "manual_command.hpp"
#include "map_command.hpp"
#include "modules_command.hpp"
#include "record_command.hpp"
#include "run_command.hpp"
#include "segment_command.hpp"
#include "simulate_command.hpp"
#include "terminal.hpp"
#include "unknown_words.hpp"
#include "usage_error.hpp"
#include "version_text.hpp"
#include "view_command.hpp"

namespace holdfast {

namespace {

constexpr int usage_exit_code = 2;

constexpr const char* description = R"(Visual SLAM for rooms where people move.

A first look:
  holdfast run demo --output out
Your own recording (TUM layout), of a room with people:
  holdfast run full --set source.tum.path=RECORDING --output out
What a configuration can say:
  holdfast modules
  holdfast modules orb
)";

constexpr const char* where_to_read_on =
    "`holdfast COMMAND --help` explains a command, `man holdfast` all of them; where the manual page is not\n"
    "installed: `holdfast manual | man -l -`.";

/// What was printed may not have arrived, as on a full disk: then the exit code says so.
int after_output(int exit_code) {
  errno = 0;
  std::cout.flush();
  if (exit_code != 0 || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout)) return exit_code;
  print_error("standard output could not be written" +
              (errno != 0 ? ": " + system_reason(errno) : "; is the disk full?"));
  return 1;
}

/// Help and version go to standard output; what is wrong with the arguments to standard error, with where to look.
int answer_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    std::ostringstream text;
    const int exit_code = app.exit(error, text, text);
    std::fputs(bold_labels(text.str(), STDOUT_FILENO).c_str(), stdout);
    return after_output(exit_code);
  }
  print_error(std::string(error.what()) + "; see `" + name_of_parsed_command(app) + " --help`");
  return usage_exit_code;
}

/// `help COMMAND` is another way to write `COMMAND --help`.
void rewrite_help(std::vector<std::string>& words) {
  if (words.empty() || words.front() != "help") return;
  words.erase(words.begin());
  if (words.empty() || words.back() != "--help") words.emplace_back("--help");
}

}  // namespace

void add_commands(CLI::App& app, int& exit_code, const ProgramHost& host) {
  app.description(description);
  app.footer(where_to_read_on);
  app.set_version_flag("-V,--version", version_text(), "Print version, commit, libraries and SIMD level");
  app.require_subcommand(1);
  add_run_command(app, exit_code, host);
  add_view_command(app, exit_code);
  add_record_command(app, exit_code, host);
  add_calibrate_command(app, exit_code, host);
  add_bench_command(app, exit_code, host);
  add_dataset_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_evaluate_segmentation_command(app, exit_code, host);
  add_evaluate_surface_command(app, exit_code);
  add_map_command(app, exit_code);
  add_background_command(app, exit_code, host);
  add_simulate_command(app, exit_code);
  add_segment_command(app, exit_code, host);
  add_check_command(app, exit_code, host);
  add_modules_command(app, exit_code, host);
  add_completion_command(app, exit_code, host);
  add_manual_command(app, exit_code);
  app.add_subcommand("help", "Print the help of a command, as COMMAND --help does");
}

int run_program(int argument_count, const char* const* arguments, const ProgramHost& host) {
  CLI::App app("", "holdfast");
  int exit_code = 0;
  add_commands(app, exit_code, host);
  std::vector<std::string> words(arguments + 1, arguments + argument_count);
  if (words.empty()) {
    std::fputs(app.help().c_str(), stderr);
    return usage_exit_code;
  }
  rewrite_help(words);
  if (const std::vector<std::string> unknown = unknown_words(app, words); !unknown.empty()) {
    for (const std::string& message : unknown) print_error(message);
    return usage_exit_code;
  }
  try {
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return answer_parse_error(app, error);
  } catch (const ConfigurationError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) print_error(diagnostic.to_string());
    return usage_exit_code;
  } catch (const UsageError& error) {
    print_error(std::string(error.what()) + "; see `" + name_of_parsed_command(app) + " --help`");
    return usage_exit_code;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 1;
  }
  return after_output(exit_code);
}

}  // namespace holdfast
