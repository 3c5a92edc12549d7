// SPDX-License-Identifier: BSD-3-Clause
#include "modules_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "built_without.hpp"
#include "holdfast/config/reference.hpp"
#include "holdfast/plugin/loader.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "program_host.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

struct ModulesArguments {
  std::string name;
  std::vector<std::string> plugins;
  bool markdown = false;
  bool json = false;
};

int print_modules(const ModulesArguments& arguments, const ProgramHost& host) {
  Registry registry = host.modules();
  for (const std::string& plugin : arguments.plugins) load_plugin(registry, plugin);
  const ReferenceFormat format = arguments.json       ? ReferenceFormat::json
                                 : arguments.markdown ? ReferenceFormat::markdown
                                                      : ReferenceFormat::text;
  std::vector<SectionDescription> sections = pipeline_sections();
  for (SectionDescription& section : simulation::scene_sections()) sections.push_back(std::move(section));
  try {
    const std::string text = reference(registry, sections, arguments.name, format);
    std::fputs((format == ReferenceFormat::text ? bold_labels(text, STDOUT_FILENO) : text).c_str(), stdout);
    if (format == ReferenceFormat::text && arguments.name.empty())
      for (const std::string& part : built_without()) std::printf("This build is without %s.\n", part.c_str());
  } catch (const Error& error) {
    print_error(error.what());
    constexpr int usage_error = 2;
    return usage_error;
  }
  return 0;
}

}  // namespace

void add_modules_command(CLI::App& app, int& exit_code, const ProgramHost& host) {
  auto arguments = std::make_shared<ModulesArguments>();
  CLI::App* command = app.add_subcommand("modules", "Print what a configuration can say: modules and their parameters");
  command->footer(
      "\nThe reference is made from the same tables that check configurations.\n\n"
      "Examples\n"
      "  holdfast modules                 all names, one line each\n"
      "  holdfast modules orb             one module with its parameters\n"
      "  holdfast modules source          all modules of a section\n"
      "  holdfast modules scene           what a scene file can say\n"
      "  holdfast modules --plugin ./libmine.so mine");
  command->add_option("NAME", arguments->name, "A module, a section, or a kind of module");
  command->add_option("--plugin", arguments->plugins, "Load this plugin first; may be repeated")
      ->allow_extra_args(false);
  CLI::Option* markdown = command->add_flag("--markdown", arguments->markdown, "As Markdown, complete");
  command->add_flag("--json", arguments->json, "As JSON, complete")->excludes(markdown);
  command->callback([arguments, host, &exit_code] { exit_code = print_modules(*arguments, host); });
}

}  // namespace holdfast
