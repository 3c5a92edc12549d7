// SPDX-License-Identifier: BSD-3-Clause
#include "variables.hpp"

#include <cstdlib>

namespace holdfast {

namespace {

/// The next "${NAME}" from `from` on: where it begins and ends, and the name. Nothing where there is none.
struct Reference {
  std::size_t begin = 0, end = 0;
  std::string name;
};
std::optional<Reference> next_reference(const std::string& text, std::size_t from) {
  while ((from = text.find("${", from)) != std::string::npos) {
    const std::size_t close = text.find('}', from);
    if (close == std::string::npos) return std::nullopt;
    const std::string name = text.substr(from + 2, close - from - 2);
    if (!name.empty() &&
        name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos)
      return Reference{from, close + 1, name};
    from += 2;
  }
  return std::nullopt;
}

std::optional<std::string> value_of(const std::string& name, const Variables& variables) {
  if (const auto given = variables.find(name); given != variables.end()) return given->second;
  if (const char* value = std::getenv(name.c_str()); value != nullptr && *value != '\0') return value;
  return std::nullopt;
}

}  // namespace

void expand_variables(std::string& text, const Variables& variables) {
  std::size_t from = 0;
  while (const auto reference = next_reference(text, from)) {
    const auto value = value_of(reference->name, variables);
    if (value) text.replace(reference->begin, reference->end - reference->begin, *value);
    from = value ? reference->begin + value->size() : reference->end;
  }
}

void expand_variables(ConfigurationNode& node, const Variables& variables) {
  if (node.kind == ConfigurationNode::Kind::scalar) expand_variables(node.text, variables);
  for (ConfigurationNode& item : node.items) expand_variables(item, variables);
  for (ConfigurationNode::Entry& entry : node.entries) expand_variables(entry.value, variables);
}

std::optional<std::string> missing_variable(const std::string& text) {
  const auto reference = next_reference(text, 0);
  return reference ? std::optional(reference->name) : std::nullopt;
}

std::optional<PlacedText> missing_variable(const ConfigurationNode& node) {
  if (const auto name = missing_variable(node.text)) return PlacedText{*name, node.location};
  for (const ConfigurationNode& item : node.items)
    if (auto found = missing_variable(item)) return found;
  for (const ConfigurationNode::Entry& entry : node.entries)
    if (auto found = missing_variable(entry.value)) return found;
  return std::nullopt;
}

}  // namespace holdfast
