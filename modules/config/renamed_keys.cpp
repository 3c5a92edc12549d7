// SPDX-License-Identifier: BSD-3-Clause
#include "renamed_keys.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace holdfast {

namespace {

using Entries = std::vector<ConfigurationNode::Entry>;

/// A parameter that was renamed, or moved to another plain section.
struct RenamedKey {
  const char* section;
  const char* filter;  ///< module in the chain `filters`, or "" for a plain section
  const char* key;
  const char* new_section;
  const char* new_key;
};

constexpr RenamedKey renamed_keys[] = {
    {"mapping", "", "close_depth_factor", "tracking", "close_depth_factor"},
    {"tracking", "", "sure_distance", "tracking", "strict_distance"},
    {"tracking", "", "possible_distance", "tracking", "loose_distance"},
    {"filters", "multi_view_depth", "sure", "filters", "confirmed_score"},
    {"filters", "reprojection_error", "least_matches", "filters", "minimum_matches"},
    {"filters", "reprojection_error", "least_found_ratio", "filters", "minimum_found_ratio"},
};

Entries::iterator find_entry(ConfigurationNode& node, const std::string& key) {
  return std::find_if(node.entries.begin(), node.entries.end(),
                      [&](const ConfigurationNode::Entry& entry) { return entry.key == key; });
}

/// The entry of the old key, taken out of its section; empty if it is not there.
Entries take_entry(ConfigurationNode& node, const std::string& key) {
  const auto found = find_entry(node, key);
  if (found == node.entries.end()) return {};
  Entries taken = {std::move(*found)};
  node.entries.erase(found);
  return taken;
}

/// The plain section, which is created at this location if the file does not have it.
ConfigurationNode& section_of(ConfigurationNode& root, const std::string& name, const SourceLocation& location) {
  if (root.find(name) == nullptr) root.entries.push_back({name, location, {}});
  ConfigurationNode& section = *root.find(name);
  if (section.kind == ConfigurationNode::Kind::nothing) {
    section.kind = ConfigurationNode::Kind::map;
    section.location = location;
  }
  return section;
}

class KeyRenaming {
 public:
  KeyRenaming(ConfigurationNode& root, Warnings& warnings, std::vector<Diagnostic>& diagnostics)
      : root_(root), warnings_(warnings), diagnostics_(diagnostics) {}

  void rename(const RenamedKey& renamed) {
    ConfigurationNode* section = root_.find(renamed.section);
    if (section == nullptr) return;
    if (*renamed.filter == '\0') return rename_in_section(renamed, *section);
    for (ConfigurationNode& item : section->items)
      if (ConfigurationNode* parameters = item.find(renamed.filter))
        for (ConfigurationNode::Entry& entry : take_entry(*parameters, renamed.key))
          add(std::move(entry), renamed.new_key, renamed.new_key, "filters '" + std::string(renamed.filter) + "'",
              *parameters);
  }

 private:
  void rename_in_section(const RenamedKey& renamed, ConfigurationNode& section) {
    for (ConfigurationNode::Entry& entry : take_entry(section, renamed.key)) {
      const SourceLocation location = entry.location;
      add(std::move(entry), renamed.new_key, std::string(renamed.new_section) + "." + renamed.new_key,
          "section '" + std::string(renamed.section) + "'", section_of(root_, renamed.new_section, location));
    }
  }

  void add(ConfigurationNode::Entry entry, const std::string& new_key, const std::string& shown_key,
           const std::string& owner, ConfigurationNode& to) {
    const std::string text = "'" + entry.key + "' of " + owner + " is now '" + shown_key + "'";
    if (find_entry(to, new_key) != to.entries.end()) {
      diagnostics_.push_back({entry.location, text + ", which has a value as well; remove one of them"});
      return;
    }
    add_warning(warnings_, {entry.location, text + "; its value is taken, but rename it"});
    entry.key = new_key;
    to.entries.push_back(std::move(entry));
  }

  ConfigurationNode& root_;
  Warnings& warnings_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace

void replace_renamed_keys(ConfigurationNode& root, Warnings& warnings, std::vector<Diagnostic>& diagnostics) {
  KeyRenaming renaming(root, warnings, diagnostics);
  for (const RenamedKey& renamed : renamed_keys) renaming.rename(renamed);
}

}  // namespace holdfast
