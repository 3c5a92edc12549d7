// SPDX-License-Identifier: BSD-3-Clause
#include "completion_words.hpp"

#include <algorithm>

#include "holdfast/config/configuration.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "installed_files.hpp"

namespace holdfast {

namespace {

/// The setting once per value that it may have, or once with an open end.
void add_settings(const std::string& path, const std::vector<Parameter>& parameters, std::vector<std::string>& words) {
  for (const Parameter& parameter : parameters) {
    const std::string key = path + "." + parameter.name + "=";
    std::vector<std::string> values;
    if (parameter.type == ParameterType::boolean) values = {"true", "false"};
    if (parameter.type == ParameterType::text) values = parameter.allowed;
    if (values.empty()) words.push_back(key);
    for (const std::string& value : values) words.push_back(key + value);
  }
}

std::vector<SectionDescription> plain_sections() {
  std::vector<SectionDescription> sections = pipeline_sections();
  sections.push_back({"run", "", ParameterTable<RunSettings>().parameters()});
  sections.push_back({"camera", "", ParameterTable<CameraSettings>().parameters()});
  sections.push_back({"imu", "", ParameterTable<ImuSettings>().parameters()});
  return sections;
}

std::vector<std::string> setting_words(const Registry& registry) {
  std::vector<std::string> words = {"camera=auto", "sensor=auto", "filters=[", "observers=["};
  for (const std::string& name : camera_names()) words.push_back("camera=" + name);
  for (const std::string& name : sensor_names()) words.push_back("sensor=" + name);
  for (const std::string& section : choice_sections())
    for (const ModuleEntry* entry : registry.of_kind(section)) {
      words.push_back(section + "=" + entry->description.name);
      add_settings(section + "." + entry->description.name, entry->parameters, words);
    }
  for (const SectionDescription& section : plain_sections()) add_settings(section.name, section.parameters, words);
  return words;
}

std::vector<std::string> module_words(const Registry& registry) {
  std::vector<std::string> words = registry.kinds();
  for (const std::string& kind : registry.kinds())
    for (const std::string& name : registry.names(kind)) words.push_back(name);
  for (const SectionDescription& section : plain_sections()) words.push_back(section.name);
  words.emplace_back("scene");
  for (const SectionDescription& section : simulation::scene_sections()) words.push_back(section.name);
  return words;
}

}  // namespace

std::vector<std::string> completion_words(CompletionWords kind, const Registry& registry) {
  std::vector<std::string> words = kind == CompletionWords::settings  ? setting_words(registry)
                                   : kind == CompletionWords::modules ? module_words(registry)
                                   : kind == CompletionWords::configurations
                                       ? installed_names(InstalledFolder::configurations)
                                       : installed_names(InstalledFolder::scenes);
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace holdfast
