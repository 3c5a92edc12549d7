// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

/// Writes down what the parser meets in the first document, and where a second one begins.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(YamlTree& tree) : tree_(tree) {}

  int documents = 0;
  YAML::Mark last_start;  ///< of the last document

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++documents;
    last_start = mark;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add({.mark = mark}, anchor); }
  void OnAlias(const YAML::Mark&, YAML::anchor_t anchor) override {
    if (documents == 1) attach(anchors_.at(anchor));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool quoted = tag == "!";  // what the parser gives to quoted scalars
    add({.kind = YamlTree::Kind::scalar, .mark = mark, .text = value, .quoted = quoted}, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back(add({.kind = YamlTree::Kind::list, .mark = mark}, anchor));
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back(add({.kind = YamlTree::Kind::map, .mark = mark}, anchor));
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  std::size_t add(YamlTree::Node node, YAML::anchor_t anchor) {
    if (documents > 1) return 0;
    const std::size_t index = tree_.nodes.size();
    tree_.nodes.push_back(std::move(node));
    if (anchor != YAML::NullAnchor) anchors_[anchor] = index;
    attach(index);
    return index;
  }

  void attach(std::size_t index) {
    if (open_.empty())
      tree_.root = index;
    else
      tree_.nodes[open_.back()].children.push_back(index);
  }

  YamlTree& tree_;
  std::vector<std::size_t> open_;  ///< the lists and maps that have begun and not ended
  std::map<YAML::anchor_t, std::size_t> anchors_;
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

}  // namespace

YamlTree read_yaml_tree(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  YamlTree tree;
  TreeBuilder builder(tree);
  parser.HandleNextDocument(builder);
  if (tree.nodes.empty()) tree.nodes.emplace_back();
  // The parser takes what it cannot continue with, such as a comma, for one more document and stays where it is: asked
  // for all documents, it would never end.
  if (!parser.HandleNextDocument(builder)) return tree;
  const YAML::Mark& second = builder.last_start;
  if (const int line = separator_line(text, second); line > 0)
    throw ConfigurationError({file, line, 1},
                             "found a second document; expected one: remove the line '---' or what follows it");
  throw ConfigurationError({file, second.line + 1, second.column + 1},
                           "syntax error: found text that continues no key, list or value; remove it, or put a value "
                           "that begins with ',' into quotes");
}

}  // namespace holdfast
