// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_places.hpp"

#include <algorithm>

#include "holdfast/config/run_settings.hpp"

namespace holdfast {

namespace {

bool has_parameter(const std::vector<Parameter>& table, const std::string& name) {
  return std::any_of(table.begin(), table.end(), [&](const Parameter& each) { return each.name == name; });
}

}  // namespace

ParameterPlaces::ParameterPlaces(const ConfigurationNode& root, const Registry& registry,
                                 const std::vector<SectionDescription>& sections)
    : registry_(registry) {
  for (const std::string& kind : choice_sections())
    if (const ConfigurationNode* node = root.find(kind)) add_module(kind, kind, *node);
  for (const char* const kind : {"filters", "observers"}) {
    const ConfigurationNode* list = root.find(kind);
    for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i)
      add_module(kind, std::string(kind) + "." + std::to_string(i), list->items[i]);
  }
  for (const SectionDescription& section : sections) selected_.emplace_back(section.name, section.parameters);
  selected_.emplace_back("run", ParameterTable<RunSettings>().parameters());
  selected_.emplace_back("camera", ParameterTable<CameraSettings>().parameters());
  selected_.emplace_back("imu", ParameterTable<ImuSettings>().parameters());
}

void ParameterPlaces::add_module(const std::string& kind, const std::string& prefix, const ConfigurationNode& node) {
  const bool is_map = node.kind == ConfigurationNode::Kind::map && !node.entries.empty();
  const std::string name = is_map ? node.entries.front().key : node.text;
  if (const ModuleEntry* entry = registry_.find(kind, name))
    selected_.emplace_back(prefix + "." + name, entry->parameters);
}

std::vector<std::string> ParameterPlaces::find(const std::string& name) const {
  constexpr std::size_t most = 3;
  std::vector<std::string> keys;
  const auto add = [&](const std::string& owner, const std::vector<Parameter>& table) {
    if (keys.size() < most && has_parameter(table, name)) keys.push_back(owner + "." + name);
  };
  for (const auto& [owner, table] : selected_) add(owner, table);
  if (!keys.empty()) return keys;
  for (const std::string& kind : registry_.kinds())
    for (const ModuleEntry* module : registry_.of_kind(kind))
      add(kind + "." + module->description.name, module->parameters);
  return keys;
}

}  // namespace holdfast
