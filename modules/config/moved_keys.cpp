// SPDX-License-Identifier: BSD-3-Clause
#include "moved_keys.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace holdfast {

namespace {

struct MovedKey {
  std::string_view section;
  std::string_view key;
  const char* now;
};

constexpr std::array moved_keys = {
    MovedKey{"mapping", "close_depth_factor", "tracking.close_depth_factor"},
};

}  // namespace

void reject_moved_keys(const std::string& section, ConfigurationNode& node, std::vector<Diagnostic>& diagnostics) {
  std::erase_if(node.entries, [&](const ConfigurationNode::Entry& entry) {
    const auto moved = std::find_if(moved_keys.begin(), moved_keys.end(), [&](const MovedKey& each) {
      return each.section == section && each.key == entry.key;
    });
    if (moved == moved_keys.end()) return false;
    diagnostics.push_back(
        {entry.location, "'" + entry.key + "' of section '" + section + "' is now '" + moved->now + "'"});
    return true;
  });
}

}  // namespace holdfast
