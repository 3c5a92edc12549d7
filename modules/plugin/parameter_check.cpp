// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/parameter_check.hpp"

#include <algorithm>

#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

ParameterValue as_wanted(const ParameterValue& value, ParameterType type) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  return integer != nullptr && type == ParameterType::real ? ParameterValue(static_cast<double>(*integer)) : value;
}

bool is_nothing(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text->empty();
  if (const auto* texts = std::get_if<TextMap>(&value)) return texts->empty();
  return false;
}

}  // namespace

ParameterValues check_parameters(const ParameterValues& given, const std::vector<Parameter>& table,
                                 const std::string& owner, const SourceLocation& place,
                                 std::vector<Diagnostic>& diagnostics) {
  ParameterValues values;
  std::vector<std::string> names;
  for (const Parameter& parameter : table) {
    names.push_back(parameter.name);
    const auto found = given.find(parameter.name);
    if (found == given.end() || (parameter.is_required && is_nothing(found->second))) {
      if (parameter.is_required)
        diagnostics.push_back({place, owner + " needs '" + parameter.name + "' (" + parameter.help + "); expected " +
                                          parameter.expectation()});
      else
        values[parameter.name] = parameter.default_value;
      continue;
    }
    const ParameterValue value = as_wanted(found->second, parameter.type);
    if (const auto reason = parameter.reject(value))
      diagnostics.push_back({place, "found " + to_string(value) + " for '" + parameter.name + "' of " + owner + ": " +
                                        *reason + "; expected " + parameter.expectation()});
    else
      values[parameter.name] = value;
  }
  for (const auto& [name, value] : given)
    if (std::find(names.begin(), names.end(), name) == names.end())
      diagnostics.push_back({place, owner + " has no parameter '" + name + "'; " + did_you_mean(name, names)});
  return values;
}

}  // namespace holdfast
