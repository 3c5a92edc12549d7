// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"

namespace holdfast {

/// Reads the values of a map by name. Whatever does not fit is appended to the diagnostics, and so is every key that
/// the map may not have.
class StrictMap {
 public:
  /// `owner` says whose keys these are ("sequence 'w21'"). A node that is no map is one more diagnostic.
  StrictMap(const ConfigurationNode& node, std::string owner, const std::vector<std::string>& known,
            std::vector<Diagnostic>& diagnostics);

  /// The value of a key; nullptr when it is not there or empty.
  const ConfigurationNode* find(const std::string& key) const;
  /// The same; that it is not there is a diagnostic.
  const ConfigurationNode* require(const std::string& key, const std::string& expected);

  std::string text(const std::string& key, const std::string& otherwise);
  std::optional<double> number(const std::string& key, double least, double most);
  std::optional<std::int64_t> integer(const std::string& key, std::int64_t least, std::int64_t most);
  bool boolean(const std::string& key, bool otherwise);

  /// Found this where that was expected.
  void mismatch(const ConfigurationNode& node, const std::string& key, const std::string& expected);
  void complain(const SourceLocation& location, const std::string& message);
  const std::string& owner() const { return owner_; }

 private:
  const ConfigurationNode& node_;
  std::string owner_;
  std::vector<Diagnostic>& diagnostics_;
};

/// The whole number that is all of an unquoted scalar.
std::optional<std::int64_t> whole_number(const ConfigurationNode& node);

/// The number that is all of an unquoted scalar.
std::optional<double> real_number(const ConfigurationNode& node);

}  // namespace holdfast
