// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/known_systems.hpp"

#include <algorithm>
#include <span>

#include "holdfast/core/embedded_file.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "missing_data.hpp"
#include "variables.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_systems();

namespace {

using Kind = ConfigurationNode::Kind;

std::string text_of(const ConfigurationNode& node, const std::string& key) {
  const ConfigurationNode* value = node.find(key);
  HOLDFAST_CHECK(value != nullptr && value->kind == Kind::scalar, "a known system without '" << key << "'");
  return value->text;
}

std::vector<std::string> texts_of(const ConfigurationNode& node, const std::string& key) {
  std::vector<std::string> texts;
  if (const ConfigurationNode* value = node.find(key))
    for (const ConfigurationNode& item : value->items) texts.push_back(item.text);
  return texts;
}

std::vector<KnownSystem> read_systems() {
  std::vector<KnownSystem> systems;
  for (const EmbeddedFile& file : embedded_systems())
    for (ConfigurationNode::Entry& entry : parse_yaml(std::string(file.content), std::string(file.name), {}).entries) {
      const ConfigurationNode& node = entry.value;
      KnownSystem system{entry.key,
                         text_of(node, "about"),
                         text_of(node, "address"),
                         text_of(node, "variable"),
                         texts_of(node, "needs"),
                         texts_of(node, "programs"),
                         text_of(node, "build"),
                         node};
      std::erase_if(system.wrapper.entries, [](const ConfigurationNode::Entry& each) {
        static const std::vector<std::string> ours = {"about", "address", "variable", "needs", "programs", "build"};
        return std::find(ours.begin(), ours.end(), each.key) != ours.end();
      });
      systems.push_back(std::move(system));
    }
  return systems;
}

/// Messages about what a wrapper gives name the place in the matrix that asks for it.
void place_at(ConfigurationNode& node, const SourceLocation& location) {
  node.location = location;
  for (ConfigurationNode& item : node.items) place_at(item, location);
  for (ConfigurationNode::Entry& entry : node.entries) {
    entry.location = location;
    place_at(entry.value, location);
  }
}

}  // namespace

const std::vector<KnownSystem>& known_systems() {
  static const std::vector<KnownSystem> systems = read_systems();
  return systems;
}

void follow_wrappers(ConfigurationNode& matrix, std::vector<Diagnostic>& diagnostics) {
  ConfigurationNode* systems = matrix.find("systems");
  if (systems == nullptr) return;
  for (ConfigurationNode::Entry& entry : systems->entries) {
    const ConfigurationNode* wrapper = entry.value.find("wrapper");
    if (wrapper == nullptr) continue;
    const std::string name = wrapper->text;
    const SourceLocation location = wrapper->location;
    std::erase_if(entry.value.entries, [](const ConfigurationNode::Entry& each) { return each.key == "wrapper"; });
    const auto known = std::find_if(known_systems().begin(), known_systems().end(),
                                    [&](const KnownSystem& system) { return system.name == name; });
    if (known == known_systems().end()) {
      std::vector<std::string> names;
      for (const KnownSystem& system : known_systems()) names.push_back(system.name);
      diagnostics.push_back({location, "there is no wrapper '" + name + "'; " + did_you_mean(name, names)});
      continue;
    }
    for (ConfigurationNode::Entry given : known->wrapper.entries) {
      if (entry.value.find(given.key) != nullptr) continue;
      given.location = location;
      place_at(given.value, location);
      entry.value.entries.push_back(std::move(given));
    }
  }
}

std::vector<SystemCheck> check_known_systems(const Variables& variables) {
  std::vector<SystemCheck> checks;
  for (const KnownSystem& system : known_systems()) {
    SystemCheck check{system.name, {}, {}};
    std::string folder = "${" + system.variable + "}";
    expand_variables(folder, variables);
    std::error_code ignored;
    if (missing_variable(folder)) {
      check.missing.push_back("the variable " + system.variable +
                              ", the folder of its build: set it in the environment or by --data " + system.variable +
                              "=FOLDER");
    } else if (!std::filesystem::is_directory(folder, ignored)) {
      check.missing.push_back("the folder '" + folder + "' that " + system.variable + " names");
    } else {
      check.found.push_back(system.variable + " = " + folder);
      for (const std::string& need : system.needs)
        (std::filesystem::exists(std::filesystem::path(folder) / need, ignored) ? check.found : check.missing)
            .push_back(need);
    }
    for (const std::string& program : system.programs)
      (is_program_in_path(program) ? check.found : check.missing).push_back("the program " + program);
    checks.push_back(std::move(check));
  }
  return checks;
}

std::string doctor_text(const std::vector<SystemCheck>& checks) {
  std::string text;
  for (const SystemCheck& check : checks) {
    const auto system = std::find_if(known_systems().begin(), known_systems().end(),
                                     [&](const KnownSystem& each) { return each.name == check.name; });
    text += check.name + ": " + (check.missing.empty() ? "ready" : "not ready") + "\n  " + system->about + "\n";
    for (const std::string& each : check.found) text += "  found    " + each + "\n";
    for (const std::string& each : check.missing) text += "  missing  " + each + "\n";
    if (!check.missing.empty()) text += "  get it from " + system->address + ": " + system->build + "\n";
  }
  return text;
}

}  // namespace holdfast
