// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

namespace {

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Gives every node of the value the place of the override, since it stands in no file.
void relocate(ConfigurationNode& node, const SourceLocation& location) {
  node.location = location;
  for (ConfigurationNode& item : node.items) relocate(item, location);
  for (ConfigurationNode::Entry& entry : node.entries) {
    entry.location = location;
    relocate(entry.value, location);
  }
}

}  // namespace

void set_value(ConfigurationNode& root, const std::string& key_path, ConfigurationNode value,
               const SourceLocation& location, const std::vector<std::string>& choices) {
  const auto fail = [&](const std::string& message) { throw ConfigurationError(location, message); };
  const std::vector<std::string> path = split(key_path);
  if (std::any_of(path.begin(), path.end(), [](const std::string& part) { return part.empty(); }))
    fail("the key '" + key_path + "' has an empty part; expected a key path, such as features.orb.count");
  constexpr std::size_t most_parts = 100;  // as deep as YAML may be, so that trees can be walked recursively
  if (path.size() > most_parts)
    fail("the key has " + std::to_string(path.size()) + " parts; expected at most " + std::to_string(most_parts));

  ConfigurationNode* node = &root;
  for (std::size_t depth = 0; depth < path.size(); ++depth) {
    const std::string& part = path[depth];
    if (node->kind == ConfigurationNode::Kind::list) {
      const auto index = parsed_number<std::size_t>(part);
      if (!index || *index >= node->items.size())
        fail("'" + part + "' is no element of the list" +
             (node->items.empty() ? std::string(", which is empty")
                                  : "; expected a number from 0 to " + std::to_string(node->items.size() - 1)));
      node = &node->items[*index];
      continue;
    }
    // A list that is not there has no elements; a map with the name "0" in its place would only confuse what reads it.
    const bool is_number = std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (depth == 1 && is_number && (node->kind != ConfigurationNode::Kind::map || node->entries.empty()))
      fail("'" + path[0] + "' has no element " + part + " to set; expected the whole list, such as " + path[0] +
           "=[a, b]");
    const bool chooses = depth == 1 && std::find(choices.begin(), choices.end(), path[0]) != choices.end();
    if (node->kind == ConfigurationNode::Kind::scalar) {
      const ConfigurationNode name = *node;
      *node = {.location = name.location, .folder = name.folder, .entries = {}};
      // `orb` stands for `orb: {}`, in a choice and as a link of a chain, and a camera's name for that camera.
      if (name.text == part)
        node->entries.push_back(
            {part, name.location, ConfigurationNode{.location = name.location, .folder = name.folder, .entries = {}}});
      else if (depth == 1 && path[0] == "camera")
        node->entries.push_back({"name", name.location, name});
    }
    node->kind = ConfigurationNode::Kind::map;
    if (chooses && node->find(part) == nullptr) node->entries.clear();
    if (node->find(part) == nullptr)
      node->entries.push_back({part, location, ConfigurationNode{.location = location, .entries = {}}});
    node = node->find(part);
  }
  *node = std::move(value);
}

void apply_override(ConfigurationNode& root, const std::string& override_text,
                    const std::vector<std::string>& choices) {
  const SourceLocation location{"--set " + override_text};
  const std::size_t equals = override_text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigurationError(location, "expected key.path=value, such as features.orb.count=500");
  ConfigurationNode value =
      parse_yaml(override_text.substr(equals + 1), location.file, std::filesystem::current_path());
  relocate(value, location);
  set_value(root, override_text.substr(0, equals), std::move(value), location, choices);
}

}  // namespace holdfast
