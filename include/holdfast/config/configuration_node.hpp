// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// A node of a configuration tree with its location in the file.
struct ConfigurationNode {
  enum class Kind { nothing, scalar, list, map };
  struct Entry;

  Kind kind = Kind::nothing;
  SourceLocation location = {};               ///< of the value
  std::filesystem::path folder = {};          ///< base of relative paths in the value
  std::string text = {};                      ///< of a scalar
  bool quoted = false;                        ///< the scalar is quoted: it is a text, even if it looks like a number
  std::vector<ConfigurationNode> items = {};  ///< of a list
  std::vector<Entry> entries;                 ///< of a map, in file order

  /// The value of a key, or nullptr.
  ConfigurationNode* find(const std::string& key);
  const ConfigurationNode* find(const std::string& key) const;

  /// Describes the value for messages: "the text 'abc'", "a list", ...
  std::string found() const;
};

/// One key of a map, and its value.
struct ConfigurationNode::Entry {
  std::string key;
  SourceLocation location;  ///< of the key
  ConfigurationNode value;
};

/// Parses YAML. Aliases are resolved. Duplicate keys, merge keys (<<) and keys that are not scalars are errors, which
/// are reported together; a syntax error is reported alone. Throws ConfigurationError. `folder` is the base of relative
/// paths.
ConfigurationNode parse_yaml(const std::string& text, const std::string& file_name,
                             const std::filesystem::path& folder);
ConfigurationNode read_yaml(const std::filesystem::path& file);

/// Sets the value at a key path, such as features.orb.count or filters.0. Numbers select elements of lists. Missing
/// sections are created. In a section that selects one module (see `choices`), the name of another module replaces the
/// selection. `location` is the location of the key path. Throws ConfigurationError.
void set_value(ConfigurationNode& root, const std::string& key_path, ConfigurationNode value,
               const SourceLocation& location, const std::vector<std::string>& choices);

/// Applies the override "key.path=value" by set_value(). The value is YAML; its relative paths start from the working
/// directory. Throws ConfigurationError.
void apply_override(ConfigurationNode& root, const std::string& override_text, const std::vector<std::string>& choices);

}  // namespace holdfast
