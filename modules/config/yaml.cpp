// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/exceptions.h>

#include <map>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/config/missing_file.hpp"
#include "holdfast/core/input_file.hpp"
#include "yaml_tree.hpp"

namespace holdfast {

ConfigurationNode* ConfigurationNode::find(const std::string& key) {
  for (Entry& entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

const ConfigurationNode* ConfigurationNode::find(const std::string& key) const {
  return const_cast<ConfigurationNode*>(this)->find(key);
}

std::string ConfigurationNode::found() const {
  switch (kind) {
    case Kind::nothing:
      return "nothing";
    case Kind::scalar:
      return "'" + text + "'";
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a map";
  }
  return "";
}

namespace {

/// Makes configuration nodes of the nodes of YAML, and finds what is no configuration.
class Converter {
 public:
  Converter(const YamlTree& tree, std::string file, std::filesystem::path folder)
      : tree_(tree), file_(std::move(file)), folder_(std::move(folder)) {}

  ConfigurationNode convert(std::size_t index) {
    // Aliases share nodes, so a short text can stand for an endless or an exponentially large tree.
    if (++depth_ > most_depth)
      throw ConfigurationError(location(index), "nested too deeply; an alias may name its own parent");
    if (++count_ > most_nodes)
      throw ConfigurationError(location(index),
                               "aliases make the file larger than " + std::to_string(most_nodes) + " values");
    ConfigurationNode result = convert_inside(index);
    --depth_;
    return result;
  }

  std::vector<Diagnostic> diagnostics;

 private:
  static constexpr int most_depth = 100;
  static constexpr int most_nodes = 100000;

  ConfigurationNode convert_inside(std::size_t index) {
    const YamlTree::Node& node = tree_.nodes[index];
    ConfigurationNode result;
    result.location = location(index);
    result.folder = folder_;
    switch (node.kind) {
      case YamlTree::Kind::scalar:
        result.kind = ConfigurationNode::Kind::scalar;
        result.text = node.text;
        result.quoted = node.quoted;
        break;
      case YamlTree::Kind::list:
        result.kind = ConfigurationNode::Kind::list;
        for (const std::size_t item : node.children) result.items.push_back(convert(item));
        break;
      case YamlTree::Kind::map:
        result.kind = ConfigurationNode::Kind::map;
        add_entries(node.children, result);
        break;
      case YamlTree::Kind::nothing:
        break;
    }
    return result;
  }

  SourceLocation location(std::size_t index) const {
    const YAML::Mark& mark = tree_.nodes[index].mark;
    return {file_, mark.line + 1, mark.column + 1};
  }

  void add_entries(const std::vector<std::size_t>& keys_and_values, ConfigurationNode& map) {
    std::map<std::string, int> lines;  // of the keys so far
    for (std::size_t i = 0; i + 1 < keys_and_values.size(); i += 2)
      add_entry(keys_and_values[i], keys_and_values[i + 1], lines, map);
  }

  void add_entry(std::size_t key_index, std::size_t value, std::map<std::string, int>& lines, ConfigurationNode& map) {
    const YamlTree::Node& key = tree_.nodes[key_index];
    const SourceLocation place = location(key_index);
    if (key.kind != YamlTree::Kind::scalar) {
      diagnostics.push_back({place, "found a key that is no plain text; expected a name"});
      return;
    }
    if (key.text == "<<") {
      diagnostics.push_back({place,
                             "merge keys (<<) are not supported; repeat the values, or use an alias (*name) for a "
                             "whole value"});
      return;
    }
    if (const auto [first, is_new] = lines.emplace(key.text, place.line); !is_new) {
      diagnostics.push_back({place, "duplicate key '" + key.text + "'; it stands already in line " +
                                        std::to_string(first->second) + "; keep one of them"});
      return;
    }
    map.entries.push_back({key.text, place, convert(value)});
  }

  const YamlTree& tree_;
  std::string file_;
  std::filesystem::path folder_;
  int depth_ = 0;
  int count_ = 0;
};

}  // namespace

ConfigurationNode parse_yaml(const std::string& text, const std::string& file_name,
                             const std::filesystem::path& folder) {
  YamlTree tree;
  try {
    tree = read_yaml_tree(text, file_name);
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(SourceLocation{file_name, error.mark.line + 1, error.mark.column + 1},
                             "syntax error: " + error.msg);
  }
  Converter converter(tree, file_name, folder);
  ConfigurationNode root = converter.convert(tree.root);
  if (!converter.diagnostics.empty()) throw ConfigurationError(converter.diagnostics);
  return root;
}

ConfigurationNode read_yaml(const std::filesystem::path& file) {
  const std::string expected = "a configuration in YAML";
  std::error_code trouble;  // a name that is too long, or below a folder that may not be read, is no file either
  if (!std::filesystem::exists(file, trouble))
    throw ConfigurationError(SourceLocation{file.string()}, missing_file_text(file, "file") + " expected " + expected);
  if (const std::string problem = why_unreadable(file, largest_file::configuration); !problem.empty())
    throw ConfigurationError(SourceLocation{file.string()}, problem + "; expected " + expected);
  const std::string text = file_content(file, largest_file::configuration, expected);
  // What comes through the system's /dev/stdin lies in no folder: paths in it count from the current one.
  const bool is_file = !file.string().starts_with("/dev/");
  return parse_yaml(text, file.string(),
                    is_file ? std::filesystem::absolute(file).parent_path() : std::filesystem::current_path());
}

}  // namespace holdfast
