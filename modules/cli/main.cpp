// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "holdfast/cli/check_command.hpp"
#include "holdfast/cli/evaluate_command.hpp"
#include "holdfast/cli/modules_command.hpp"
#include "holdfast/cli/run_command.hpp"
#include "holdfast/cli/simulate_command.hpp"
#include "holdfast/cli/terminal.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/version.hpp"

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
  std::fprintf(stderr, "%s %s\n", holdfast::red("error:", STDERR_FILENO).c_str(), message.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  using namespace holdfast;
  CLI::App app(description, "holdfast");
  app.set_version_flag("--version", "holdfast " HOLDFAST_VERSION);
  app.require_subcommand(1);
  int exit_code = 0;
  add_run_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_check_command(app, exit_code);
  add_modules_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const ConfigurationError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) print_error(diagnostic.to_string());
    return 2;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 1;
  }
  return exit_code;
}
