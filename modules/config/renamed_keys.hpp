// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/warning.hpp"

namespace holdfast {

/// Replaces the keys of earlier versions by those of today, with a warning for each that names the new one. A file that
/// sets both is an error, which is appended to `diagnostics`.
void replace_renamed_keys(ConfigurationNode& root, Warnings& warnings, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
