// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Reads a map of parameters by their table. Every unknown name, wrong type, value out of range and missing required
/// parameter is appended to `diagnostics`. The result holds the given or default value of every valid parameter.
/// `owner` names the owner of the parameters in messages ("features 'orb'"). An empty node counts as an empty map.
ParameterValues read_parameters(const ConfigurationNode& node, const std::vector<Parameter>& table,
                                const std::string& owner, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
