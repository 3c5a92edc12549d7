// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace holdfast {

/// Text by text, in the order of the file.
using TextMap = std::vector<std::pair<std::string, std::string>>;

/// The value of a parameter, as it stands in a configuration.
using ParameterValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<double>, TextMap>;

enum class ParameterType { boolean, integer, real, text, path, text_list, real_list, text_map };
const char* to_string(ParameterType type);
/// As it would stand in YAML, on one line.
std::string to_string(const ParameterValue& value);

/// One row of a parameter table: all that is known about a parameter. The same row gives the default, the checks and
/// the reference that `holdfast modules` prints.
struct Parameter {
  std::string name;
  ParameterType type = ParameterType::real;
  ParameterValue default_value;
  std::string help;
  std::string unit_name;
  bool is_required = false;
  std::optional<double> minimum;  ///< of a number, or of every number of a list
  std::optional<double> maximum;
  std::vector<std::string> allowed;  ///< of a text, or of every text of a list; empty = any

  Parameter& range(double low, double high) { return at_least(low).at_most(high); }
  Parameter& at_least(double low) { minimum = low; return *this; }
  Parameter& at_most(double high) { maximum = high; return *this; }
  Parameter& unit(std::string name_of_unit) { unit_name = std::move(name_of_unit); return *this; }
  Parameter& one_of(std::initializer_list<std::string> texts) { allowed = texts; return *this; }
  /// Has no default: a configuration without it is an error.
  Parameter& required() { is_required = true; return *this; }

  /// What is expected, in words: "a number from 1 to 8 [m]".
  std::string expectation() const;
  /// Why a value of the right type is not acceptable, or nothing.
  std::optional<std::string> reject(const ParameterValue& value) const;
};

/// Values by parameter name.
using ParameterValues = std::map<std::string, ParameterValue>;

}  // namespace holdfast
