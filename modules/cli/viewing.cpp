// SPDX-License-Identifier: BSD-3-Clause
#include "viewing.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

#include "holdfast/core/error.hpp"
#include "holdfast/viewer/viewer.hpp"
#include "server_addresses.hpp"
#include "terminal.hpp"
#include "viewed_run.hpp"

namespace holdfast {

namespace {

/// A signal does not wake a sleep of the standard library, so that this is how long the end may take.
constexpr auto nap = std::chrono::milliseconds(50);

void wait_for_end() {
  while (!interrupted()) std::this_thread::sleep_for(nap);
}

}  // namespace

void add_viewer(Configuration& configuration, const Registry& registry) {
  constexpr const char* name = "viewer";
  for (const ModuleChoice& observer : configuration.observers)
    if (observer.name == name) return;
  ModuleChoice choice{.kind = "observers", .name = name, .values = {}, .location = {"--view"}};
  const ModuleEntry* entry = registry.find(choice.kind, name);
  if (entry == nullptr) throw PluginError("--view needs the observer 'viewer', which these modules do not contain");
  for (const Parameter& parameter : entry->parameters) choice.values[parameter.name] = parameter.default_value;
  configuration.observers.push_back(std::move(choice));
}

std::vector<std::shared_ptr<Viewer>> running_viewers_of_program() { return running_viewers(); }

void show_until_stopped(const std::vector<std::shared_ptr<Viewer>>& viewers, const RunRecord& record) {
  for (const auto& viewer : viewers) viewer->set_run(viewed_run(record));
  if (viewers.empty() || record.was_interrupted) return;
  std::printf("%-20s %s\n", "", "shows the result until Ctrl-C");
  print_server_addresses();
  wait_for_end();
}

void show_results_until_stopped(const std::filesystem::path& results, const std::string& listen, int port) {
  catch_interrupts();
  FoundResults found = find_results(results);
  const std::shared_ptr<Viewer> viewer =
      Viewer::start({.listen = listen, .port = port, .title = found.run.title, .camera = found.run.camera});
  if (!found.class_names.empty()) {
    viewer->set_classes(std::move(found.class_names));
    viewer->add_point_classes(std::move(found.classes));
  }
  if (found.map) viewer->set_map(std::move(*found.map), 0.0);
  viewer->set_run(std::move(found.run));
  print_server_addresses();
  std::printf("%-20s %s\n", "", "until Ctrl-C");
  std::fflush(stdout);
  wait_for_end();
}

}  // namespace holdfast
