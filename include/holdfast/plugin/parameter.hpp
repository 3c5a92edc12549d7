// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace holdfast {

/// Text by text, in the order of the file.
using TextMap = std::vector<std::pair<std::string, std::string>>;

/// Rows of numbers, such as the places of a path.
using RealTable = std::vector<std::vector<double>>;

/// The value of a parameter, as it stands in a configuration.
using ParameterValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>,
                                    std::vector<double>, TextMap, RealTable>;

enum class ParameterType { boolean, integer, real, text, path, text_list, real_list, text_map, real_table };
const char* to_string(ParameterType type);
/// As it would stand in YAML, on one line.
std::string to_string(const ParameterValue& value);
/// The double with the fewest digits that is nearest to this float of all floats: 0.1F gives 0.1, so that references
/// and resolved configurations show what was written, and the way back is exact.
double shortest_double(float number);

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
  std::int64_t least_integer = std::numeric_limits<std::int64_t>::min();  ///< what the bound member can hold
  std::int64_t most_integer = std::numeric_limits<std::int64_t>::max();

  Parameter& range(double low, double high) { return at_least(low).at_most(high); }
  Parameter& at_least(double low) {
    minimum = low;
    return *this;
  }
  Parameter& at_most(double high) {
    maximum = high;
    return *this;
  }
  Parameter& unit(std::string name_of_unit) {
    unit_name = std::move(name_of_unit);
    return *this;
  }
  Parameter& one_of(std::vector<std::string> texts) {
    allowed = std::move(texts);
    return *this;
  }
  /// Has no default: a configuration without it is an error.
  Parameter& required() {
    is_required = true;
    return *this;
  }

  /// What is expected, in words: "a number from 1 to 8 [m]".
  std::string expectation() const;
  /// "from 1 to 8", "of at least 1", "" where anything goes.
  std::string range_text() const;
  /// Why a value is not acceptable ("9 is above 8"), or nothing.
  std::optional<std::string> reject(const ParameterValue& value) const;
};

/// Values by parameter name.
using ParameterValues = std::map<std::string, ParameterValue>;

}  // namespace holdfast
