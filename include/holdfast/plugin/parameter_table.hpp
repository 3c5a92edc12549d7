// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "holdfast/plugin/choice.hpp"
#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

namespace detail {

/// The rows of a parameter table without the members that they are bound to. Compiled once, as is all that does not
/// depend on the settings struct.
class ParameterRows {
 public:
  ParameterRows();
  ~ParameterRows();
  ParameterRows(const ParameterRows&) = delete;
  ParameterRows& operator=(const ParameterRows&) = delete;

  /// Adds a row. The reference stays valid.
  Parameter& add(std::string name, ParameterType type, ParameterValue default_value, std::string help);
  std::size_t size() const;
  /// The value of a row's parameter, or nullptr if it is not given.
  const ParameterValue* find(const ParameterValues& values, std::size_t row) const;
  void set(ParameterValues& values, std::size_t row, ParameterValue value) const;
  std::vector<Parameter> parameters() const;

 private:
  struct Rows;
  std::unique_ptr<Rows> rows_;
};

template <class Member>
constexpr ParameterType parameter_type_of() {
  if constexpr (std::is_same_v<Member, bool>)
    return ParameterType::boolean;
  else if constexpr (std::is_integral_v<Member>)
    return ParameterType::integer;
  else if constexpr (std::is_floating_point_v<Member>)
    return ParameterType::real;
  else if constexpr (std::is_same_v<Member, std::string> || NamedEnum<Member>)
    return ParameterType::text;
  else if constexpr (std::is_same_v<Member, std::filesystem::path>)
    return ParameterType::path;
  else if constexpr (std::is_same_v<Member, std::vector<std::string>>)
    return ParameterType::text_list;
  else if constexpr (std::is_same_v<Member, std::vector<double>>)
    return ParameterType::real_list;
  else if constexpr (std::is_same_v<Member, RealTable>)
    return ParameterType::real_table;
  else if constexpr (std::is_same_v<Member, RealMap>)
    return ParameterType::real_map;
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
  else if constexpr (NamedEnum<Member>)
    return std::string(choice_name(member));
  else
    return member;
}

// A template over the value, too, so that std::get is compiled only where a table is.
template <class Value, class Member>
void from_parameter_value(const Value& value, Member& member) {
  if constexpr (std::is_same_v<Member, bool>)
    member = std::get<bool>(value);
  else if constexpr (std::is_integral_v<Member>)
    member = static_cast<Member>(std::get<std::int64_t>(value));
  else if constexpr (std::is_floating_point_v<Member>)
    member = static_cast<Member>(std::get<double>(value));
  else if constexpr (std::is_same_v<Member, std::filesystem::path>)
    member = std::get<std::string>(value);
  else if constexpr (NamedEnum<Member>)
    member = choice_value<Member>(std::get<std::string>(value));
  else
    member = std::get<Member>(value);
}

}  // namespace detail

/// The parameter table of a settings struct. Every row is bound to a member, whose initial value is the default. A
/// settings struct has plain public members and a function `static void describe(ParameterTable<Settings>&)`:
///
///     struct OrbSettings {
///       int count = 1000;
///       static void describe(ParameterTable<OrbSettings>& table) {
///         table.add("count", &OrbSettings::count, "features to keep of an image").range(50, 20000);
///       }
///     };
///
/// The same struct is used for configuration in YAML and in C++. A member of an enum type is a choice of names
/// (choice.hpp): a text in YAML, an enum in the code.
template <class Settings>
class ParameterTable {
 public:
  ParameterTable() { Settings::describe(*this); }

  template <class Member>
  Parameter& add(std::string name, Member Settings::*member, std::string help) {
    Parameter& parameter = rows_.add(std::move(name), detail::parameter_type_of<Member>(),
                                     detail::to_parameter_value(Settings{}.*member), std::move(help));
    if constexpr (NamedEnum<Member>) parameter.allowed = choice_names<Member>();
    if constexpr (std::is_integral_v<Member>) {
      if constexpr (std::is_unsigned_v<Member>)
        parameter.min_integer = 0;
      else
        parameter.min_integer = std::numeric_limits<Member>::min();
      if constexpr (sizeof(Member) < sizeof(std::int64_t)) parameter.max_integer = std::numeric_limits<Member>::max();
    }
    readers_.push_back([member](const Settings& s) { return detail::to_parameter_value(s.*member); });
    writers_.push_back([member](const ParameterValue& v, Settings& s) { detail::from_parameter_value(v, s.*member); });
    return parameter;
  }

  std::vector<Parameter> parameters() const { return rows_.parameters(); }

  /// Settings with the given values; a parameter that is not given keeps its default. The values must have passed the
  /// checks.
  Settings settings(const ParameterValues& values) const {
    Settings result;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (const ParameterValue* value = rows_.find(values, i)) writers_[i](*value, result);
    return result;
  }

  /// All values of settings by name, as the resolved configuration shows them.
  ParameterValues values(const Settings& settings) const {
    ParameterValues result;
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_.set(result, i, readers_[i](settings));
    return result;
  }

 private:
  detail::ParameterRows rows_;
  std::vector<std::function<ParameterValue(const Settings&)>> readers_;
  std::vector<std::function<void(const ParameterValue&, Settings&)>> writers_;
};

}  // namespace holdfast
