// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/parameter_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "holdfast/core/parsed_number.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

using Kind = ConfigurationNode::Kind;

/// The number that is all of an unquoted scalar.
template <class Number>
std::optional<Number> as_number(const ConfigurationNode& node) {
  if (node.kind != Kind::scalar || node.quoted || node.text.empty()) return std::nullopt;
  const bool plus = node.text.front() == '+' && !node.text.starts_with("+-");  // parsed_number() knows no plus
  return parsed_number<Number>(std::string_view(node.text).substr(plus ? 1 : 0));
}

std::optional<double> as_real(const ConfigurationNode& node) {
  const auto number = as_number<double>(node);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<std::vector<double>> as_reals(const ConfigurationNode& node) {
  std::vector<double> numbers;
  if (node.kind != Kind::list) return std::nullopt;
  for (const ConfigurationNode& item : node.items) {
    const auto number = as_real(item);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<ParameterValue> as_type(const ConfigurationNode& node, ParameterType type) {
  switch (type) {
    case ParameterType::boolean:
      if (node.kind != Kind::scalar || node.quoted || (node.text != "true" && node.text != "false"))
        return std::nullopt;
      return node.text == "true";
    case ParameterType::integer:
      if (const auto number = as_number<std::int64_t>(node)) return *number;
      return std::nullopt;
    case ParameterType::real:
      if (const auto number = as_real(node)) return *number;
      return std::nullopt;
    case ParameterType::text:
      if (node.kind != Kind::scalar) return std::nullopt;
      return node.text;
    case ParameterType::path: {
      if (node.kind != Kind::scalar) return std::nullopt;
      if (node.text.empty()) return node.text;
      const std::filesystem::path path = node.text;
      return (path.is_absolute() ? path : node.folder / path).lexically_normal().string();
    }
    case ParameterType::text_list: {
      std::vector<std::string> texts;
      if (node.kind != Kind::list) return std::nullopt;
      for (const ConfigurationNode& item : node.items) {
        if (item.kind != Kind::scalar) return std::nullopt;
        texts.push_back(item.text);
      }
      return texts;
    }
    case ParameterType::real_list:
      if (auto numbers = as_reals(node)) return *numbers;
      return std::nullopt;
    case ParameterType::real_table: {
      RealTable rows;
      if (node.kind != Kind::list) return std::nullopt;
      for (const ConfigurationNode& item : node.items) {
        auto row = as_reals(item);
        if (!row) return std::nullopt;
        rows.push_back(std::move(*row));
      }
      return rows;
    }
    case ParameterType::text_map: {
      TextMap map;
      if (node.kind != Kind::map) return std::nullopt;
      for (const ConfigurationNode::Entry& entry : node.entries) {
        if (entry.value.kind != Kind::scalar) return std::nullopt;
        map.emplace_back(entry.key, entry.value.text);
      }
      return map;
    }
    case ParameterType::real_map: {
      RealMap map;
      if (node.kind != Kind::map) return std::nullopt;
      for (const ConfigurationNode::Entry& entry : node.entries) {
        const auto number = as_real(entry.value);
        if (!number) return std::nullopt;
        map.emplace_back(entry.key, *number);
      }
      return map;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string suggest_parameter(const std::string& name, const std::vector<std::string>& known,
                              const FindParameter& elsewhere) {
  const std::vector<std::string> keys = elsewhere ? elsewhere(name) : std::vector<std::string>{};
  if (keys.empty()) return did_you_mean(name, known);
  std::string text = "it is ";
  for (std::size_t i = 0; i < keys.size(); ++i) text += (i == 0 ? "`" : " or `") + keys[i] + "`";
  return nearest_name(name, known) ? text + "; or " + did_you_mean(name, known) : text;
}

ParameterValues read_parameters(const ConfigurationNode& node, const std::vector<Parameter>& table,
                                const std::string& owner, std::vector<Diagnostic>& diagnostics,
                                const FindParameter& elsewhere) {
  ParameterValues values;
  if (node.kind != Kind::map && node.kind != Kind::nothing) {
    diagnostics.push_back({node.location, "found " + node.found() + "; expected the parameters of " + owner +
                                              " as a map, such as { name: value }"});
    return values;
  }
  std::vector<std::string> names;
  for (const Parameter& parameter : table) names.push_back(parameter.name);
  for (const ConfigurationNode::Entry& entry : node.entries) {
    const auto parameter =
        std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == entry.key; });
    if (parameter == table.end()) {
      diagnostics.push_back({entry.location, owner + " has no parameter '" + entry.key + "'; " +
                                                 suggest_parameter(entry.key, names, elsewhere)});
      continue;
    }
    const std::string name = "'" + entry.key + "' of " + owner;
    const auto value = as_type(entry.value, parameter->type);
    if (!value) {
      diagnostics.push_back({entry.value.location, "found " + entry.value.found() + " for " + name + "; expected " +
                                                       parameter->expectation()});
      continue;
    }
    if (const auto reason = parameter->reject(*value)) {
      diagnostics.push_back({entry.value.location, "found " + entry.value.found() + " for " + name + ": " + *reason +
                                                       "; expected " + parameter->expectation()});
      continue;
    }
    values[entry.key] = *value;
  }
  for (const Parameter& parameter : table) {
    if (node.find(parameter.name) != nullptr) continue;
    if (parameter.is_required)
      diagnostics.push_back({node.location, owner + " needs '" + parameter.name + "' (" + parameter.help +
                                                "); expected " + parameter.expectation()});
    else
      values[parameter.name] = parameter.default_value;
  }
  return values;
}

}  // namespace holdfast
