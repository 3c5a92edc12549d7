// SPDX-License-Identifier: BSD-3-Clause
#include "preset.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <span>
#include <vector>

#include "holdfast/core/embedded_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_onnx_presets();

namespace onnx_plugin {

namespace {

/// The parameters that a preset may have: those that say what the network takes and gives.
std::vector<Parameter> preset_parameters() {
  const std::set<std::string> others = {"model",     "preset",   "engine", "engine_library",
                                        "precision", "provider", "threads"};
  std::vector<Parameter> parameters = ParameterTable<OnnxSettings>().parameters();
  std::erase_if(parameters, [&](const Parameter& parameter) { return others.contains(parameter.name); });
  return parameters;
}

ParameterValue value_of(const YAML::Node& node, ParameterType type) {
  switch (type) {
    case ParameterType::integer:
      return node.as<std::int64_t>();
    case ParameterType::real:
      return node.as<double>();
    case ParameterType::real_list:
      return node.as<std::vector<double>>();
    case ParameterType::text_list:
      return node.as<std::vector<std::string>>();
    default:
      return node.as<std::string>();
  }
}

SourceLocation location_of(const YAML::Node& node, const std::string& file) {
  return {file, node.Mark().line + 1, node.Mark().column + 1};
}

/// Reads the values of a preset from a map; `file` is named in messages.
ParameterValues read_values(const YAML::Node& map, const std::string& file) {
  if (!map.IsMap())
    throw InputError(
        SourceLocation{file},
        "is no map; expected parameters of the segmenter `onnx` and their values, such as `min_score: 0.4`");
  const std::vector<Parameter> parameters = preset_parameters();
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  ParameterValues values;
  for (const auto& entry : map) {
    const std::string name = entry.first.Scalar();
    const SourceLocation location = location_of(entry.first, file);
    const auto parameter = std::find(names.begin(), names.end(), name);
    if (parameter == names.end())
      throw InputError(location, "'" + name + "' is no parameter of a preset; " + did_you_mean(name, names));
    if (values.contains(name)) throw InputError(location, "'" + name + "' stands there twice; expected it once");
    const Parameter& row = parameters[static_cast<std::size_t>(parameter - names.begin())];
    try {
      values[name] = value_of(entry.second, row.type);
    } catch (const YAML::Exception&) {
      throw InputError(location, name + " is not what it must be; expected " + row.expectation());
    }
    if (const auto reason = row.reject(values[name]))
      throw InputError(location, name + ": " + *reason + "; expected " + row.expectation());
  }
  return values;
}

ParameterValues read_file(const std::filesystem::path& file) {
  const std::string content = file_content(file, largest_file::configuration, "a preset of the segmenter `onnx`");
  try {
    return read_values(YAML::Load(content), file.string());
  } catch (const YAML::Exception& problem) {
    throw InputError(SourceLocation{file.string(), problem.mark.line + 1, problem.mark.column + 1},
                     problem.msg + "; expected YAML");
  }
}

}  // namespace

ParameterValues shipped_preset(const std::string& name) {
  const EmbeddedFile& file = embedded_onnx_presets().front();
  const YAML::Node presets = YAML::Load(std::string(file.content));
  std::vector<std::string> names;
  for (const auto& preset : presets) {
    if (preset.first.Scalar() == name) return read_values(preset.second, std::string(file.name));
    names.push_back(preset.first.Scalar());
  }
  throw ConfigurationError(SourceLocation{}, "segmenter.onnx.preset: there is no preset '" + name + "'; " +
                                                 did_you_mean(name, names) + "; a file of one ends in .yaml");
}

OnnxSettings with_named_preset(const OnnxSettings& settings) {
  if (settings.preset.empty()) return settings;
  const std::filesystem::path file = settings.preset;
  const bool is_file = file.extension() == ".yaml" || file.extension() == ".yml";
  if (is_file) return with_preset(settings, read_file(settings.model.parent_path() / file));
  ParameterValues preset = shipped_preset(settings.preset);
  const std::vector<std::string> families = choice_names<ObjectFamily>();
  if (std::find(families.begin(), families.end(), settings.preset) != families.end())
    preset["family"] = settings.preset;
  return with_preset(settings, preset);
}

OnnxSettings with_preset(const OnnxSettings& settings, const ParameterValues& preset) {
  const ParameterTable<OnnxSettings> table;
  const ParameterValues defaults = table.values({});
  ParameterValues values = table.values(settings);
  std::vector<std::string> taken;
  for (const auto& [name, value] : preset)
    if (values.at(name) == defaults.at(name)) {
      values[name] = value;
      taken.push_back(name);
    }
  OnnxSettings result = table.settings(values);
  const auto of_preset = preset.find("colour_order");
  const bool preset_is_bgr = of_preset != preset.end() && of_preset->second == ParameterValue(std::string("bgr"));
  if ((result.colour_order == ColourOrder::bgr) == preset_is_bgr) return result;
  for (const auto& [name, numbers] :
       {std::pair("mean", &result.mean), std::pair("standard_deviation", &result.standard_deviation)})
    if (std::find(taken.begin(), taken.end(), name) != taken.end()) std::reverse(numbers->begin(), numbers->end());
  return result;
}

std::string colour_text(const OnnxSettings& settings) {
  const auto of = [](const std::vector<double>& numbers, std::size_t channel, double otherwise) {
    return channel < numbers.size() ? numbers[channel] : otherwise;
  };
  const auto range = [&](double pixel) {
    std::vector<std::string> texts;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      char text[32];
      std::snprintf(
          text, sizeof(text), "%.4g",
          (pixel * settings.scale - of(settings.mean, channel, 0.0)) / of(settings.standard_deviation, channel, 1.0));
      texts.emplace_back(text);
    }
    if (texts[0] == texts[1] && texts[1] == texts[2]) return texts[0];
    return "(" + texts[0] + " " + texts[1] + " " + texts[2] + ")";
  };
  return std::string(settings.colour_order == ColourOrder::bgr ? "bgr" : "rgb") + " from " + range(0.0) + " to " +
         range(255.0);
}

}  // namespace onnx_plugin

}  // namespace holdfast
