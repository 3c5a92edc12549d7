// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/text_file.hpp"

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
    // Aliases share nodes, so a short text can stand for an endless or an exponentially large tree.
    if (++depth_ > most_depth)
      throw ConfigurationError(location(node), "nested too deeply; an alias may name its own parent");
    if (++count_ > most_nodes)
      throw ConfigurationError(location(node),
                               "aliases make the file larger than " + std::to_string(most_nodes) + " values");
    ConfigurationNode result = convert_inside(node);
    --depth_;
    return result;
  }

  std::vector<Diagnostic> diagnostics;

 private:
  static constexpr int most_depth = 100;
  static constexpr int most_nodes = 100000;

  ConfigurationNode convert_inside(const YAML::Node& node) {
    ConfigurationNode result;
    result.location = location(node);
    result.folder = folder_;
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
        add_entries(node, result);
        break;
      case YAML::NodeType::Null:
      case YAML::NodeType::Undefined:
        break;
    }
    return result;
  }

  SourceLocation location(const YAML::Node& node) const {
    const YAML::Mark mark = node.Mark();  // counts from 0, -1 = unknown
    return {file_, mark.line + 1, mark.column + 1};
  }

  void add_entries(const YAML::Node& node, ConfigurationNode& map) {
    std::map<std::string, int> lines;  // of the keys so far
    for (const auto& pair : node) add_entry(pair.first, pair.second, lines, map);
  }

  void add_entry(const YAML::Node& key, const YAML::Node& value, std::map<std::string, int>& lines,
                 ConfigurationNode& map) {
    const SourceLocation place = location(key);
    if (!key.IsScalar()) {
      diagnostics.push_back({place, "found a key that is no plain text; expected a name"});
      return;
    }
    if (key.Scalar() == "<<") {
      diagnostics.push_back({place,
                             "merge keys (<<) are not supported; repeat the values, or use an alias (*name) for a "
                             "whole value"});
      return;
    }
    if (const auto [first, is_new] = lines.emplace(key.Scalar(), place.line); !is_new) {
      diagnostics.push_back({place, "duplicate key '" + key.Scalar() + "'; it stands already in line " +
                                        std::to_string(first->second) + "; keep one of them"});
      return;
    }
    map.entries.push_back({key.Scalar(), place, convert(value)});
  }

  std::string file_;
  std::filesystem::path folder_;
  int depth_ = 0;
  int count_ = 0;
};

/// Where the documents of a text begin; builds nothing.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { starts.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  std::vector<YAML::Mark> starts;
};

/// The line that separates a second document from the first, which begins at `mark`; 0 where there is none.
int separator_line(const std::string& text, const YAML::Mark& mark) {
  std::istringstream lines(text);
  bool began = false;
  int number = 1;
  for (std::string line; number <= mark.line + 1 && std::getline(lines, line); ++number) {
    const bool is_mark = line.starts_with("---") || line.starts_with("...");
    if (is_mark && began) return number;
    if (!is_mark && line.find_first_not_of(" \t\r") != std::string::npos && line.front() != '#') began = true;
  }
  return 0;
}

/// Throws where the text goes on after its first document. The parser takes what it cannot continue with, such as a
/// comma, for one more document and stays where it is: asked for all documents, it would never end.
void require_one_document(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts documents;
  if (!parser.HandleNextDocument(documents) || !parser.HandleNextDocument(documents)) return;
  const YAML::Mark& second = documents.starts.back();
  if (const int line = separator_line(text, second); line > 0)
    throw ConfigurationError({file, line, 1},
                             "found a second document; expected one: remove the line '---' or what follows it");
  throw ConfigurationError({file, second.line + 1, second.column + 1},
                           "syntax error: found text that continues no key, list or value; remove it, or put a value "
                           "that begins with ',' into quotes");
}

}  // namespace

ConfigurationNode parse_yaml(const std::string& text, const std::string& file_name,
                             const std::filesystem::path& folder) {
  YAML::Node document;
  try {
    require_one_document(text, file_name);
    document = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(SourceLocation{file_name, error.mark.line + 1, error.mark.column + 1},
                             "syntax error: " + error.msg);
  }
  Converter converter(file_name, folder);
  ConfigurationNode root = converter.convert(document);
  if (!converter.diagnostics.empty()) throw ConfigurationError(converter.diagnostics);
  return root;
}

ConfigurationNode read_yaml(const std::filesystem::path& file) {
  if (is_named_pipe(file))
    throw ConfigurationError(SourceLocation{file.string()},
                             "is a named pipe, which may never end; expected a configuration in YAML");
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw ConfigurationError(SourceLocation{file.string()},
                             std::string(!std::filesystem::exists(file)        ? "there is no such file"
                                         : std::filesystem::is_directory(file) ? "is a folder"
                                                                               : "cannot be read") +
                                 "; expected a configuration in YAML");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  // What comes through the system's /dev/stdin lies in no folder: paths in it count from the current one.
  const bool is_file = !file.string().starts_with("/dev/");
  return parse_yaml(text, file.string(),
                    is_file ? std::filesystem::absolute(file).parent_path() : std::filesystem::current_path());
}

}  // namespace holdfast
