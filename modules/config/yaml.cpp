// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>

#include "holdfast/config/configuration_node.hpp"

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

class Converter {
 public:
  Converter(std::string file, std::filesystem::path folder) : file_(std::move(file)), folder_(std::move(folder)) {}

  ConfigurationNode convert(const YAML::Node& node) {
    ConfigurationNode result;
    result.location = location(node);
    result.folder = folder_;
    // Aliases share nodes and may even contain themselves; copies of them must end.
    if (depth_ >= most_depth || ++nodes_ > most_nodes) {
      if (!too_large_)
        diagnostics.push_back({result.location,
                               "found a value that is nested too deeply or repeated too often; expected "
                               "no alias (*name) inside of what it names"});
      too_large_ = true;
      return result;
    }
    ++depth_;
    switch (node.Type()) {
      case YAML::NodeType::Scalar:
        result.kind = ConfigurationNode::Kind::scalar;
        result.text = node.Scalar();
        result.quoted = node.Tag() == "!";  // what the parser gives to quoted scalars
        break;
      case YAML::NodeType::Sequence:
        result.kind = ConfigurationNode::Kind::list;
        for (const YAML::Node& item : node) result.items.push_back(convert(item));
        break;
      case YAML::NodeType::Map:
        result.kind = ConfigurationNode::Kind::map;
        for (const auto& pair : node) add_entry(pair.first, pair.second, result);
        break;
      case YAML::NodeType::Null:
      case YAML::NodeType::Undefined:
        break;
    }
    --depth_;
    return result;
  }

  std::vector<Diagnostic> diagnostics;

 private:
  SourceLocation location(const YAML::Node& node) const {
    const YAML::Mark mark = node.Mark();  // counts from 0, -1 = unknown
    return {file_, mark.line + 1, mark.column + 1};
  }

  void add_entry(const YAML::Node& key, const YAML::Node& value, ConfigurationNode& map) {
    const SourceLocation place = location(key);
    if (!key.IsScalar()) {
      diagnostics.push_back({place, "found a key that is no plain text; expected a name"});
      return;
    }
    if (key.Scalar() == "<<" && key.Tag() != "!") {
      diagnostics.push_back({place,
                             "merge keys (<<) are not supported; repeat the values, or use an alias (*name) for a "
                             "whole value"});
      return;
    }
    for (const ConfigurationNode::Entry& entry : map.entries)
      if (entry.key == key.Scalar()) {
        diagnostics.push_back({place, "duplicate key '" + key.Scalar() + "'; it stands already in line " +
                                          std::to_string(entry.location.line) + "; keep one of them"});
        return;
      }
    map.entries.push_back({key.Scalar(), place, convert(value)});
    // The parser places a value that is not there where the next thing begins.
    ConfigurationNode& added = map.entries.back().value;
    if (added.kind == ConfigurationNode::Kind::nothing) added.location = place;
  }

  static constexpr int most_depth = 64;
  static constexpr int most_nodes = 100000;

  std::string file_;
  std::filesystem::path folder_;
  int depth_ = 0;
  int nodes_ = 0;
  bool too_large_ = false;
};

}  // namespace

ConfigurationNode parse_yaml(const std::string& text, const std::string& file_name,
                             const std::filesystem::path& folder) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(SourceLocation{file_name, error.mark.line + 1, error.mark.column + 1},
                             "syntax error: " + error.msg);
  }
  Converter converter(file_name, folder);
  ConfigurationNode root = documents.empty() ? ConfigurationNode{.location = {file_name}, .folder = folder}
                                             : converter.convert(documents.front());
  if (documents.size() > 1)
    throw ConfigurationError(SourceLocation{file_name}, "found " + std::to_string(documents.size()) +
                                                            " documents (separated by ---); expected one");
  if (!converter.diagnostics.empty()) throw ConfigurationError(converter.diagnostics);
  return root;
}

ConfigurationNode read_yaml(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto refuse = [&](const std::string& reason) {
    throw ConfigurationError(SourceLocation{file.string()}, reason + "; expected a configuration in YAML");
  };
  if (!std::filesystem::exists(file, ignored)) refuse("there is no such file");
  if (std::filesystem::is_directory(file, ignored)) refuse("is a folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse("cannot be read");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_yaml(text, file.string(), std::filesystem::absolute(file).parent_path());
}

}  // namespace holdfast
