// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "background_command.hpp"
#include "bench_command.hpp"
#include "check_command.hpp"
#include "dataset_command.hpp"
#include "evaluate_command.hpp"
#include "evaluate_segmentation_command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "map_command.hpp"
#include "modules_command.hpp"
#include "run_command.hpp"
#include "segment_command.hpp"
#include "simulate_command.hpp"
#include "terminal.hpp"

namespace {

constexpr const char* description = R"(Visual SLAM for rooms where people move.

A first look:
  holdfast run examples/configs/demo.yaml --output out
Your own recording (TUM layout):
  holdfast run examples/configs/rgbd.yaml --set source.tum.path=RECORDING --output out
What a configuration can say:
  holdfast modules
  holdfast modules orb
)";

void print_error(const std::string& message) {
  std::fprintf(stderr, "%s %s\n", holdfast::red("error:", STDERR_FILENO).c_str(), holdfast::printable(message).c_str());
}

/// A word where a command should stand, or one of a command's own: CLI11 would only say that a command is required.
bool is_unknown_command(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return false;
  const std::string& word = words.front();
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (names.empty() || word.starts_with('-')) return false;
  if (std::find(names.begin(), names.end(), word) != names.end())
    return is_unknown_command(*app.get_subcommand(word), {words.begin() + 1, words.end()});
  print_error("there is no command '" + word + "'; " + holdfast::did_you_mean(word, names));
  return true;
}

/// What was printed may not have arrived, as on a full disk: then the exit code says so.
int after_output(int exit_code) {
  std::cout.flush();
  if (exit_code != 0 || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout)) return exit_code;
  print_error("standard output could not be written; is the disk full?");
  return 1;
}

/// Help and version go to standard output; what is wrong with the arguments to standard error, with where to look.
int answer_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return after_output(app.exit(error));
  std::string command = "holdfast";
  for (const CLI::App* parsed : app.get_subcommands()) command += " " + parsed->get_name();
  print_error(std::string(error.what()) + "; see `" + command + " --help`");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace holdfast;
  CLI::App app(description, "holdfast");
  app.set_version_flag("--version", "holdfast " HOLDFAST_VERSION);
  app.require_subcommand(1);
  int exit_code = 0;
  add_run_command(app, exit_code);
  add_bench_command(app, exit_code);
  add_dataset_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_evaluate_segmentation_command(app, exit_code);
  add_map_command(app, exit_code);
  add_background_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_segment_command(app, exit_code);
  add_check_command(app, exit_code);
  add_modules_command(app, exit_code);
  if (argc == 1) {
    std::fputs(app.help().c_str(), stderr);
    return 2;
  }
  if (is_unknown_command(app, {argv + 1, argv + argc})) return 2;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer_parse_error(app, error);
  } catch (const ConfigurationError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) print_error(diagnostic.to_string());
    return 2;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 1;
  }
  return after_output(exit_code);
}
