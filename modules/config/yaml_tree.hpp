// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/mark.h>

#include <cstddef>
#include <string>
#include <vector>

namespace holdfast {

/// The first document of a YAML text as its nodes, before anything is said about what they mean. An alias is the node
/// that it names, so a node can have several parents, and can be its own ancestor.
struct YamlTree {
  enum class Kind { nothing, scalar, list, map };

  struct Node {
    Kind kind = Kind::nothing;
    YAML::Mark mark = YAML::Mark::null_mark();  ///< counts from 0; -1 where there is no text
    std::string text = {};                      ///< of a scalar
    bool quoted = false;                        ///< of a scalar
    std::vector<std::size_t> children = {};     ///< of a list; of a map key, value, key, value, ...
  };

  std::vector<Node> nodes;
  std::size_t root = 0;
};

/// Reads a text in one pass. Throws YAML::Exception with the mark of a syntax error, and ConfigurationError where the
/// text goes on after its first document. An empty text gives a single node of the kind `nothing`.
YamlTree read_yaml_tree(const std::string& text, const std::string& file);

}  // namespace holdfast
