// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Full keys of the parameters of that name in other sections.
using FindParameter = std::function<std::vector<std::string>(const std::string& name)>;

/// Reads a map of parameters by their table. Every unknown name, wrong type, value out of range and missing required
/// parameter is appended to `diagnostics`. The result holds the given or default value of every valid parameter.
/// `owner` names the owner of the parameters in messages ("features 'orb'"). An empty node counts as an empty map. With
/// `elsewhere`, the message about an unknown name says in which other section it is known.
ParameterValues read_parameters(const ConfigurationNode& node, const std::vector<Parameter>& table,
                                const std::string& owner, std::vector<Diagnostic>& diagnostics,
                                const FindParameter& elsewhere = {});
/// The remedy for a name that is not known here: "it is `source.tum.depth_factor`" if it is elsewhere, and the similar
/// one of `known` names.
std::string suggest_parameter(const std::string& name, const std::vector<std::string>& known,
                              const FindParameter& elsewhere);

}  // namespace holdfast
