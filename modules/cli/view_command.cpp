// SPDX-License-Identifier: BSD-3-Clause
#include "view_command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "viewing.hpp"

namespace holdfast {

namespace {

struct ViewArguments {
  std::filesystem::path results;
  std::string listen = "127.0.0.1";
  int port = 0;
};

}  // namespace

void add_view_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "Show the results of a run, or a map, in the browser");
  command->footer(
      "\nPrints an address to open and serves it until Ctrl-C. The page shows map, path, keyframes and loops; where "
      "the\n"
      "recording had ground truth, the path is coloured by its error and the true path is beside it; a dense\n"
      "static_map.ply is shown as well. `holdfast run --view` shows the same while a run goes.\n\n"
      "Examples\n"
      "  holdfast view out/demo\n"
      "  holdfast view out/demo/map.hfm --port 8080");
  command->add_option("RESULTS", arguments->results, "Folder of a run, or a map (.hfm)")
      ->required()
      ->check(CLI::ExistingPath);
  command
      ->add_option("--listen", arguments->listen, "Numeric address to serve at; others than loopback open it to others")
      ->capture_default_str();
  command->add_option("--port", arguments->port, "Port to serve at; 0 = any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->callback([arguments, &exit_code] {
    show_results_until_stopped(arguments->results, arguments->listen, arguments->port);
    exit_code = 0;
  });
}

}  // namespace holdfast
