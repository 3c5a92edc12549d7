// SPDX-License-Identifier: BSD-3-Clause
#include "check_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "configured_command.hpp"
#include "holdfast/config/configuration.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "program_host.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

struct CheckArguments {
  std::string configuration;
  std::vector<std::string> overrides;
  bool print = false, without_data = false;
};

void check(const CheckArguments& arguments, const ProgramHost& host) {
  Registry registry = host.modules();
  const Configuration configuration = load_configuration(arguments.configuration, arguments.overrides, registry);
  print_warnings(configuration.warnings);
  // Makes every module and looks at the data as `run` does before the first frame; nothing is written.
  if (!arguments.without_data) {
    BuiltPipeline built = build_pipeline(configuration, registry);
    built.pipeline.finish_loading();
    print_warnings(built.warnings());
    if (const SourceDescription source = built.source->describe(); !arguments.print && source.has_imu)
      std::printf("imu: %s\n", source.imu || configuration.imu
                                   ? "measurements predict poses where tracking.inertia is true"
                                   : "measurements are not used without a calibration; add the section 'imu'");
    const std::string understood = built.pipeline.segmenter_description();
    if (!arguments.print && !understood.empty())
      std::printf("%s: %s\n", configuration.segmenter.name.c_str(), printable(understood).c_str());
  }
  if (arguments.print) {
    std::fputs(to_yaml(configuration).c_str(), stdout);
    return;
  }
  std::string chain = configuration.source.name + " -> " + configuration.features.name;
  if (configuration.segmenter.name != "none") chain += " -> " + configuration.segmenter.name;
  for (const ModuleChoice& filter : configuration.filters) chain += " -> " + filter.name;
  chain += " -> " + configuration.optimizer.name;
  if (configuration.loop_detector.name != "none") chain += " -> " + configuration.loop_detector.name;
  std::printf("%s %s: %s\n", green("ok", STDOUT_FILENO).c_str(), printable(arguments.configuration).c_str(),
              chain.c_str());
}

}  // namespace

void add_check_command(CLI::App& app, int&, const ProgramHost& host) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand("check", "Check a configuration without running it");
  command->footer(
      "\nEvery mistake is reported at once, as file:line:column: what was found, what was expected. Then every module\n"
      "is made as `holdfast run` does before the first frame: recordings, scenes and networks are looked for. Exits 2\n"
      "when the configuration is wrong, 1 when something that it names cannot be used.\n\n"
      "Examples\n"
      "  holdfast check examples/configs/rgbd.yaml --without-data\n"
      "  holdfast check rgbd.yaml --set features.orb.count=1500 --print");
  add_configuration_options(*command, arguments->configuration, arguments->overrides);
  command->add_flag("--without-data", arguments->without_data,
                    "Look at the configuration alone: the recordings and files that it names may be elsewhere");
  command->add_flag("--print", arguments->print, "Print the resolved configuration: every default written out");
  command->callback([arguments, host] { check(*arguments, host); });
}

}  // namespace holdfast
