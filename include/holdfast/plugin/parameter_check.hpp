// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Checks values that a program gives by name against a table, as a configuration's are: every unknown name, wrong
/// type, value out of range and missing required parameter is appended to `diagnostics` with the given place. An
/// integer counts as a real where the table wants one. `owner` names whose parameters these are ("features 'orb'").
/// Returns the values with the defaults of what was not given.
ParameterValues check_parameters(const ParameterValues& given, const std::vector<Parameter>& table,
                                 const std::string& owner, const SourceLocation& place,
                                 std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
