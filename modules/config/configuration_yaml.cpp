// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/configuration.hpp"

namespace holdfast {

namespace {

void add_values(const ParameterValues& values, const std::string& indent, std::string& yaml) {
  for (const auto& [name, value] : values) yaml += indent + name + ": " + to_string(value) + "\n";
}

void add_module(const ModuleChoice& choice, const std::string& first, const std::string& indent, std::string& yaml) {
  if (choice.values.empty()) {
    yaml += first + choice.name + ": {}\n";
    return;
  }
  yaml += first + choice.name + ":\n";
  add_values(choice.values, indent + "  ", yaml);
}

void add_choice(const ModuleChoice& choice, std::string& yaml) {
  yaml += choice.kind + ":\n";
  add_module(choice, "  ", "  ", yaml);
}

void add_chain(const std::string& kind, const std::vector<ModuleChoice>& choices, std::string& yaml) {
  yaml += kind + ":" + (choices.empty() ? " []\n" : "\n");
  for (const ModuleChoice& choice : choices) add_module(choice, "  - ", "    ", yaml);
}

/// Results are shown to others: tokens are secrets, and without one an observer makes a new one.
std::vector<ModuleChoice> without_tokens(std::vector<ModuleChoice> observers) {
  for (ModuleChoice& observer : observers)
    if (const auto token = observer.values.find("token"); token != observer.values.end()) token->second = std::string();
  return observers;
}

}  // namespace

std::string to_yaml(const Configuration& configuration) {
  std::string yaml;
  add_choice(configuration.source, yaml);
  if (configuration.camera) {
    yaml += "camera:\n";
    add_values(ParameterTable<CameraSettings>().values(camera_settings(*configuration.camera)), "  ", yaml);
  }
  if (configuration.imu) {
    yaml += "imu:\n";
    add_values(ParameterTable<ImuSettings>().values(imu_settings(*configuration.imu)), "  ", yaml);
  }
  yaml += std::string("sensor: ") + (configuration.sensor ? sensor_name(*configuration.sensor) : "auto") + "\n";
  add_choice(configuration.features, yaml);
  add_choice(configuration.matcher, yaml);
  add_choice(configuration.segmenter, yaml);
  add_chain("filters", configuration.filters, yaml);
  add_choice(configuration.optimizer, yaml);
  add_choice(configuration.loop_detector, yaml);
  add_chain("observers", without_tokens(configuration.observers), yaml);
  for (const auto& [name, values] : configuration.sections) {
    yaml += name + ":\n";
    add_values(values, "  ", yaml);
  }
  yaml += "run:\n";
  add_values(ParameterTable<RunSettings>().values(configuration.run), "  ", yaml);
  yaml += "plugins: " + to_string(ParameterValue(configuration.plugins)) + "\n";
  return yaml;
}

}  // namespace holdfast
