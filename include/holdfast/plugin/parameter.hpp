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

/// Key-value pairs in file order.
using TextMap = std::vector<std::pair<std::string, std::string>>;

/// Numbers by name, in file order, such as a weight of each of some classes.
using RealMap = std::vector<std::pair<std::string, double>>;

/// Rows of numbers, such as the waypoints of a path.
using RealTable = std::vector<std::vector<double>>;

/// The value of a parameter.
using ParameterValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>,
                                    std::vector<double>, TextMap, RealTable, RealMap>;

enum class ParameterType { boolean, integer, real, text, path, text_list, real_list, text_map, real_table, real_map };
const char* to_string(ParameterType type);
/// YAML of the value, on one line.
std::string to_string(const ParameterValue& value);
/// The double with the fewest decimal digits that rounds to this float: 0.1F gives 0.1. References and resolved
/// configurations then show the written number, and the conversion back to float is exact.
double shortest_double(float number);

/// One row of a parameter table. The same row gives the default, the checks and the reference that `holdfast modules`
/// prints.
struct Parameter {
  std::string name;
  ParameterType type = ParameterType::real;
  ParameterValue default_value;
  std::string help;
  std::string unit_name;
  bool is_required = false;
  std::optional<double> minimum;     ///< bound of a number, or of every number of a list or map
  std::optional<double> maximum;     ///< bound of a number, or of every number of a list or map
  std::vector<std::string> allowed;  ///< names for a text, or for every text of a list; empty = any text
  std::int64_t min_integer = std::numeric_limits<std::int64_t>::min();  ///< smallest value of the member's type
  std::int64_t max_integer = std::numeric_limits<std::int64_t>::max();  ///< largest value of the member's type

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
  /// Removes the default: a configuration without this parameter is an error.
  Parameter& required() {
    is_required = true;
    return *this;
  }

  /// Describes the expected value: "a number from 1 to 8 [m]".
  std::string expectation() const;
  /// Describes the bounds: "from 1 to 8", "of at least 1", or "" without bounds.
  std::string range_text() const;
  /// The reason why a value is refused ("9 is above 8"); empty for an acceptable value.
  std::optional<std::string> reject(const ParameterValue& value) const;
};

/// Values by parameter name.
using ParameterValues = std::map<std::string, ParameterValue>;

}  // namespace holdfast
