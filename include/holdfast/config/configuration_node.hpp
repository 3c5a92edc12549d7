// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// A piece of a configuration that remembers where it stands.
struct ConfigurationNode {
  enum class Kind { nothing, scalar, list, map };
  struct Entry;

  Kind kind = Kind::nothing;
  SourceLocation location = {};               ///< of the value
  std::filesystem::path folder = {};          ///< that relative paths start from
  std::string text = {};                      ///< of a scalar
  bool quoted = false;                        ///< the scalar stands in quotes, so it is a text whatever it looks like
  std::vector<ConfigurationNode> items = {};  ///< of a list
  std::vector<Entry> entries;                 ///< of a map, in the order of the file

  /// The value of a key, or nullptr.
  ConfigurationNode* find(const std::string& key);
  const ConfigurationNode* find(const std::string& key) const;

  /// What was found, for messages: "the text 'abc'", "a list", ...
  std::string found() const;
};

/// One key of a map, and its value.
struct ConfigurationNode::Entry {
  std::string key;
  SourceLocation location;  ///< of the key
  ConfigurationNode value;
};

/// Reads YAML. Aliases are followed; duplicate keys, merge keys (<<) and keys that are no scalars are errors, all
/// reported together; a syntax error is reported alone. Throws ConfigurationError. `folder` is where relative paths
/// start from.
ConfigurationNode parse_yaml(const std::string& text, const std::string& file_name,
                             const std::filesystem::path& folder);
ConfigurationNode read_yaml(const std::filesystem::path& file);

/// Sets the value at a key path, such as features.orb.count or filters.0. Elements of lists are named by number.
/// Missing sections are made. In a section that chooses one module (see `choices`) naming another module replaces the
/// choice. `location` is where the key path stands. Throws ConfigurationError.
void set_value(ConfigurationNode& root, const std::string& key_path, ConfigurationNode value,
               const SourceLocation& location, const std::vector<std::string>& choices);

/// Applies "key.path=value" as if the file said so, by set_value(). The value is YAML; relative paths in it start from
/// the working directory. Throws ConfigurationError.
void apply_override(ConfigurationNode& root, const std::string& override_text, const std::vector<std::string>& choices);

}  // namespace holdfast
