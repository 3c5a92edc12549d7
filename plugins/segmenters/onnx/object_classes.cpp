// SPDX-License-Identifier: BSD-3-Clause
#include "object_classes.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast::onnx_plugin {

namespace {

constexpr std::size_t most_classes = 254;

}  // namespace

void check_class_names(const std::vector<std::string>& classes, const std::vector<std::string>& movable,
                       std::size_t least) {
  std::vector<Diagnostic> diagnostics;
  const auto problem = [&](const std::string& message) { diagnostics.push_back({{}, "segmenter.onnx." + message}); };
  if (classes.size() < least || classes.size() > most_classes)
    problem("classes: found " + counted(classes.size(), "name") + "; expected " + std::to_string(least) + " to " +
            std::to_string(most_classes));
  for (auto name = classes.begin(); name != classes.end(); ++name) {
    if (name->empty()) problem("classes: a name is empty");
    if (std::find(classes.begin(), name, *name) != name)
      problem("classes: '" + *name + "' stands there twice; expected different names");
  }
  for (const std::string& name : movable)
    if (std::find(classes.begin(), classes.end(), name) == classes.end())
      problem("movable: '" + name + "' is none of the classes; " + did_you_mean(name, classes));
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
}

ObjectClasses object_classes(const OnnxSettings& settings, const ModelMetadata& metadata) {
  ObjectClasses result{{"background"}, settings.movable, settings.classes.empty()};
  const std::vector<std::string>& given = result.are_of_metadata ? metadata.names : settings.classes;
  if (result.are_of_metadata && given.size() >= most_classes)
    throw InputError({settings.model.string()}, "has the names of " + std::to_string(given.size()) +
                                                    " classes in its metadata; expected at most " +
                                                    std::to_string(most_classes - 1) + ", because labels have 8 bits");
  const bool has_background = !result.are_of_metadata && given.front() == "background";
  if (!result.are_of_metadata && !metadata.names.empty() &&
      given.size() - (has_background ? 1 : 0) != metadata.names.size())
    throw ConfigurationError(SourceLocation{}, "segmenter.onnx.classes: found " + counted(given.size(), "name") +
                                                   ", but the metadata of " + settings.model.filename().string() +
                                                   " names " + class_text(metadata.names) +
                                                   "; expected a name for each; leave `classes` out, and say what can "
                                                   "move in `movable`");
  for (std::size_t i = has_background ? 1 : 0; i < given.size(); ++i)
    result.names.push_back(given[i] == "background" && result.are_of_metadata ? "background class" : given[i]);
  const bool is_named = result.count() > 0;
  if (!result.are_of_metadata || is_named) check_class_names(result.names, result.movable, 2);
  const auto has = [&](const char* name) {
    return std::find(result.names.begin(), result.names.end(), name) != result.names.end();
  };
  if (settings.movable.empty() && has("person")) result.movable = {"person"};
  return result;
}

std::string class_text(const std::vector<std::string>& names) {
  constexpr std::size_t most = 5;
  std::string listed;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i) listed += (i == 0 ? "" : ", ") + names[i];
  return std::to_string(names.size()) + (names.size() == 1 ? " class (" : " classes (") + listed +
         (names.size() > most ? ", ...)" : ")");
}

}  // namespace holdfast::onnx_plugin
