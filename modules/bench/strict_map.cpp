// SPDX-License-Identifier: BSD-3-Clause
#include "strict_map.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/parsed_number.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

using Kind = ConfigurationNode::Kind;

namespace {

template <class Number>
std::optional<Number> whole_text(const ConfigurationNode& node) {
  if (node.kind != Kind::scalar || node.quoted) return std::nullopt;
  return parsed_number<Number>(node.text);
}

}  // namespace

std::optional<std::int64_t> whole_number(const ConfigurationNode& node) { return whole_text<std::int64_t>(node); }

std::optional<double> real_number(const ConfigurationNode& node) { return whole_text<double>(node); }

StrictMap::StrictMap(const ConfigurationNode& node, std::string owner, const std::vector<std::string>& known,
                     std::vector<Diagnostic>& diagnostics)
    : node_(node), owner_(std::move(owner)), diagnostics_(diagnostics) {
  if (node.kind != Kind::map)
    complain(node.location, "found " + node.found() + " for " + owner_ + "; expected a map, such as { " +
                                (known.empty() ? "name" : known.front()) + ": ... }");
  for (const ConfigurationNode::Entry& entry : node.entries)
    if (std::find(known.begin(), known.end(), entry.key) == known.end())
      complain(entry.location, owner_ + " has no key '" + entry.key + "'; " + did_you_mean(entry.key, known));
}

const ConfigurationNode* StrictMap::find(const std::string& key) const {
  const ConfigurationNode* node = node_.find(key);
  return node == nullptr || node->kind == Kind::nothing ? nullptr : node;
}

const ConfigurationNode* StrictMap::require(const std::string& key, const std::string& expected) {
  const ConfigurationNode* node = find(key);
  if (node == nullptr && node_.kind == Kind::map)
    complain(node_.location, owner_ + " needs '" + key + "'; expected " + expected);
  return node;
}

std::string StrictMap::text(const std::string& key, const std::string& otherwise) {
  const ConfigurationNode* node = find(key);
  if (node == nullptr) return otherwise;
  if (node->kind == Kind::scalar) return node->text;
  mismatch(*node, key, "a text");
  return otherwise;
}

std::optional<double> StrictMap::number(const std::string& key, double least, double most) {
  const ConfigurationNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = whole_text<double>(*node);
  if (value && *value >= least && *value <= most) return value;
  mismatch(*node, key, "a number from " + shortest_text(least) + " to " + shortest_text(most));
  return std::nullopt;
}

std::optional<std::int64_t> StrictMap::integer(const std::string& key, std::int64_t least, std::int64_t most) {
  const ConfigurationNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = whole_number(*node);
  if (value && *value >= least && *value <= most) return value;
  mismatch(*node, key, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return std::nullopt;
}

bool StrictMap::boolean(const std::string& key, bool otherwise) {
  const ConfigurationNode* node = find(key);
  if (node == nullptr) return otherwise;
  if (node->kind == Kind::scalar && !node->quoted && (node->text == "true" || node->text == "false"))
    return node->text == "true";
  mismatch(*node, key, "true or false");
  return otherwise;
}

void StrictMap::mismatch(const ConfigurationNode& node, const std::string& key, const std::string& expected) {
  complain(node.location, "found " + node.found() + " for '" + key + "' of " + owner_ + "; expected " + expected);
}

void StrictMap::complain(const SourceLocation& location, const std::string& message) {
  diagnostics_.push_back({location, message});
}

}  // namespace holdfast
