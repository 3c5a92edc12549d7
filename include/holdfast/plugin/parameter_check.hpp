// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

/// Checks named values of a program against a parameter table, as for a configuration: unknown names, wrong types,
/// values out of range and missing required parameters are appended to `diagnostics` with the given location. Integers
/// are accepted for reals. `owner` names the module in messages ("features 'orb'"). Returns all values, with the
/// defaults of missing ones.
ParameterValues check_parameters(const ParameterValues& given, const std::vector<Parameter>& table,
                                 const std::string& owner, const SourceLocation& place,
                                 std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
