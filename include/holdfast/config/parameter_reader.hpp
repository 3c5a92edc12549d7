// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Reads a map of parameters by their table: every unknown name, wrong type, value out of range and missing required
/// parameter is appended to `diagnostics`; the result holds a value, given or default, for every parameter that is
/// right. `owner` names whose parameters these are ("features 'orb'"); nothing counts as an empty map.
ParameterValues read_parameters(const ConfigurationNode& node, const std::vector<Parameter>& table,
                                const std::string& owner, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
