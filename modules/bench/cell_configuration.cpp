// SPDX-License-Identifier: BSD-3-Clause
#include "cell_configuration.hpp"

#include <algorithm>

namespace holdfast {

using Kind = ConfigurationNode::Kind;

namespace {

/// The module that a section of a configuration chooses; "" when that cannot be said.
std::string chosen_module(const ConfigurationNode& root, const std::string& section) {
  const ConfigurationNode* node = root.find(section);
  if (node == nullptr) return "none";
  if (node->kind == Kind::scalar) return node->text;
  return node->entries.size() == 1 ? node->entries.front().key : "";
}

ConfigurationNode scalar(const std::string& text, const SourceLocation& location) {
  ConfigurationNode node;
  node.kind = Kind::scalar;
  node.location = location;
  node.text = text;
  return node;
}

}  // namespace

const ConfigurationNode* CellConfigurations::file(const PlacedText& path) {
  if (!files_.contains(path.text)) {
    auto& entry = files_[path.text];
    try {
      entry = read_yaml(path.text);
    } catch (const ConfigurationError& error) {
      for (const Diagnostic& diagnostic : error.diagnostics())
        diagnostics_.push_back(diagnostic.location.line > 0
                                   ? diagnostic
                                   : Diagnostic{path.location, "'" + path.text + "': " + diagnostic.message});
    }
  }
  const auto& root = files_[path.text];
  return root ? &*root : nullptr;
}

bool CellConfigurations::set(ConfigurationNode& root, const KeyValue& change) {
  try {
    set_value(root, change.key, change.value, change.location, choice_sections());
    return true;
  } catch (const ConfigurationError& error) {
    diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
    return false;
  }
}

void CellConfigurations::override_for_sequence(ConfigurationNode& root, const MatrixSequence& sequence,
                                               const std::vector<const AxisValue*>& values) {
  for (const KeyValue& change : sequence.overrides) {
    const bool set_by_axis = std::any_of(values.begin(), values.end(), [&](const AxisValue* value) {
      return std::any_of(value->overrides.begin(), value->overrides.end(),
                         [&](const KeyValue& other) { return other.key == change.key; });
    });
    if (set_by_axis) continue;
    const std::size_t first = change.key.find('.');
    const std::string section = change.key.substr(0, first);
    const auto& choices = choice_sections();
    if (first != std::string::npos && std::find(choices.begin(), choices.end(), section) != choices.end()) {
      const std::size_t second = change.key.find('.', first + 1);
      if (change.key.substr(first + 1, second - first - 1) != chosen_module(root, section)) continue;
    }
    set(root, change);
  }
}

void CellConfigurations::check_without_file(const PlacedText& path, const std::vector<const AxisValue*>& values,
                                            const MatrixSequence& sequence) {
  ConfigurationNode root;
  root.kind = Kind::map;
  root.location.file = path.text;
  const std::size_t before = diagnostics_.size();
  set(root, {"source", sequence.location, sequence.source});
  if (sequence.camera) set(root, {"camera", sequence.location, *sequence.camera});
  for (const AxisValue* value : values)
    for (const KeyValue& change : value->overrides) set(root, change);
  diagnostics_.resize(before);  // a change of what only the file holds is no mistake
  try {
    resolve_configuration(root, path.text, registry_, sections_);
  } catch (const ConfigurationError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics())
      if (diagnostic.location.file != path.text && diagnostic.location.line > 0) diagnostics_.push_back(diagnostic);
  }
}

std::optional<Configuration> CellConfigurations::build(const std::vector<const AxisValue*>& values,
                                                       const MatrixSequence& sequence) {
  const PlacedText* path = matrix_.base ? &*matrix_.base : nullptr;
  for (const AxisValue* value : values)
    if (value->configuration) path = &*value->configuration;
  if (path == nullptr) return std::nullopt;
  const ConfigurationNode* file_root = file(*path);
  if (file_root == nullptr) {
    check_without_file(*path, values, sequence);
    return std::nullopt;
  }

  const std::size_t before = diagnostics_.size();
  ConfigurationNode root = *file_root;
  set(root, {"source", sequence.location, sequence.source});
  if (sequence.camera)
    set(root, {"camera", sequence.location, *sequence.camera});
  else if (sequence.brings_camera)
    std::erase_if(root.entries, [](const ConfigurationNode::Entry& entry) { return entry.key == "camera"; });
  if (matrix_.mode) set(root, {"run.mode", matrix_.mode->location, scalar(matrix_.mode->text, matrix_.mode->location)});
  for (const AxisValue* value : values)
    for (const KeyValue& change : value->overrides) set(root, change);
  override_for_sequence(root, sequence, values);
  if (diagnostics_.size() != before) return std::nullopt;
  try {
    return resolve_configuration(root, path->text, registry_, sections_);
  } catch (const ConfigurationError& error) {
    diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
    return std::nullopt;
  }
}

namespace {

/// The first module of a kind that needs no settings.
std::string any_module(const Registry& registry, const std::string& kind) {
  for (const std::string& name : registry.names(kind)) {
    const std::vector<Parameter>& parameters = registry.find(kind, name)->parameters;
    if (std::none_of(parameters.begin(), parameters.end(), [](const Parameter& each) { return each.is_required; }))
      return name;
  }
  return "none";
}

}  // namespace

std::optional<Configuration> CellConfigurations::build_recording(const MatrixSequence& sequence,
                                                                 const AxisValue* perturbation) {
  ConfigurationNode root;
  root.kind = Kind::map;
  root.location.file = matrix_.file.string();
  const std::size_t before = diagnostics_.size();
  set(root, {"source", sequence.location, sequence.source});
  if (sequence.camera) set(root, {"camera", sequence.location, *sequence.camera});
  // A configuration must have these, and a recording does not run them.
  for (const char* section : {"features", "optimizer"})
    set(root, {section, sequence.location, scalar(any_module(registry_, section), sequence.location)});
  if (perturbation != nullptr)
    for (const KeyValue& change : perturbation->overrides) set(root, change);
  if (diagnostics_.size() != before) return std::nullopt;
  try {
    return resolve_configuration(root, matrix_.file.string(), registry_, sections_);
  } catch (const ConfigurationError& error) {
    diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
    return std::nullopt;
  }
}

}  // namespace holdfast
