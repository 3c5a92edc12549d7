// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

namespace detail {

template <class Member>
constexpr ParameterType parameter_type_of() {
  if constexpr (std::is_same_v<Member, bool>)
    return ParameterType::boolean;
  else if constexpr (std::is_integral_v<Member>)
    return ParameterType::integer;
  else if constexpr (std::is_floating_point_v<Member>)
    return ParameterType::real;
  else if constexpr (std::is_same_v<Member, std::string>)
    return ParameterType::text;
  else if constexpr (std::is_same_v<Member, std::filesystem::path>)
    return ParameterType::path;
  else if constexpr (std::is_same_v<Member, std::vector<std::string>>)
    return ParameterType::text_list;
  else if constexpr (std::is_same_v<Member, std::vector<double>>)
    return ParameterType::real_list;
  else if constexpr (std::is_same_v<Member, RealTable>)
    return ParameterType::real_table;
  else {
    static_assert(std::is_same_v<Member, TextMap>, "no parameter type for this member");
    return ParameterType::text_map;
  }
}

template <class Member>
ParameterValue to_parameter_value(const Member& member) {
  if constexpr (std::is_same_v<Member, bool>)
    return member;
  else if constexpr (std::is_integral_v<Member>)
    return static_cast<std::int64_t>(member);
  else if constexpr (std::is_same_v<Member, float>)
    return shortest_double(member);
  else if constexpr (std::is_floating_point_v<Member>)
    return static_cast<double>(member);
  else if constexpr (std::is_same_v<Member, std::filesystem::path>)
    return member.string();
  else
    return member;
}

template <class Member>
void from_parameter_value(const ParameterValue& value, Member& member) {
  if constexpr (std::is_same_v<Member, bool>)
    member = std::get<bool>(value);
  else if constexpr (std::is_integral_v<Member>)
    member = static_cast<Member>(std::get<std::int64_t>(value));
  else if constexpr (std::is_floating_point_v<Member>)
    member = static_cast<Member>(std::get<double>(value));
  else if constexpr (std::is_same_v<Member, std::filesystem::path>)
    member = std::get<std::string>(value);
  else
    member = std::get<Member>(value);
}

}  // namespace detail

/// The parameter table of a settings struct: every row is bound to a member, whose initial value is the default. A
/// settings struct is plain public members plus `static void describe(ParameterTable<Settings>&)`:
///
///     struct OrbSettings {
///       int count = 1000;
///       static void describe(ParameterTable<OrbSettings>& table) {
///         table.add("count", &OrbSettings::count, "features to keep of an image").range(50, 20000);
///       }
///     };
///
/// So the same struct serves those who configure in YAML and those who configure in C++.
template <class Settings>
class ParameterTable {
 public:
  ParameterTable() { Settings::describe(*this); }

  template <class Member>
  Parameter& add(std::string name, Member Settings::*member, std::string help) {
    Parameter& parameter = parameters_.emplace_back();
    parameter.name = std::move(name);
    parameter.type = detail::parameter_type_of<Member>();
    parameter.default_value = detail::to_parameter_value(Settings{}.*member);
    parameter.help = std::move(help);
    if constexpr (std::is_integral_v<Member>) {
      if constexpr (std::is_unsigned_v<Member>)
        parameter.least_integer = 0;
      else
        parameter.least_integer = std::numeric_limits<Member>::min();
      if constexpr (sizeof(Member) < sizeof(std::int64_t)) parameter.most_integer = std::numeric_limits<Member>::max();
    }
    readers_.push_back([member](const Settings& s) { return detail::to_parameter_value(s.*member); });
    writers_.push_back([member](const ParameterValue& v, Settings& s) { detail::from_parameter_value(v, s.*member); });
    return parameter;
  }

  std::vector<Parameter> parameters() const { return {parameters_.begin(), parameters_.end()}; }

  /// Settings with the given values; what is not given keeps its default. The values must have passed the checks.
  Settings settings(const ParameterValues& values) const {
    Settings result;
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      if (auto found = values.find(parameters_[i].name); found != values.end()) writers_[i](found->second, result);
    return result;
  }

  /// All values of settings, by name: what the resolved configuration shows.
  ParameterValues values(const Settings& settings) const {
    ParameterValues result;
    for (std::size_t i = 0; i < parameters_.size(); ++i) result[parameters_[i].name] = readers_[i](settings);
    return result;
  }

 private:
  std::deque<Parameter> parameters_;  // a deque: add() hands out references
  std::vector<std::function<ParameterValue(const Settings&)>> readers_;
  std::vector<std::function<void(const ParameterValue&, Settings&)>> writers_;
};

}  // namespace holdfast
