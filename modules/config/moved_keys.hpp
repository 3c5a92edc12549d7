// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"

namespace holdfast {

/// Removes the keys of a plain section that earlier versions had, and appends an error for each to `diagnostics`, which
/// names the key that replaces it.
void reject_moved_keys(const std::string& section, ConfigurationNode& node, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
