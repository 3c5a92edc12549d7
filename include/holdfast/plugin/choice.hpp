// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// One value of an enum and its name in a configuration.
template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

/// The names of an enum's values, in the order of the reference. A settings struct with a member of this enum type
/// needs a specialisation beside the enum:
///
///     enum class Interpolation { nearest, linear };
///     template <>
///     inline constexpr Choice<Interpolation> choice_table<Interpolation>[] = {{"nearest", Interpolation::nearest},
///                                                                             {"linear", Interpolation::linear}};
template <class Enum>
inline constexpr bool choice_table = false;

/// An enum whose values have names, so that it can be the type of a parameter.
template <class Enum>
concept NamedEnum = std::is_enum_v<Enum> && std::is_array_v<decltype(choice_table<Enum>)>;

/// The name of a value. Throws CheckError for a value without a name.
template <NamedEnum Enum>
const char* choice_name(Enum value) {
  for (const Choice<Enum>& choice : choice_table<Enum>)
    if (choice.value == value) return choice.name;
  HOLDFAST_CHECK(false, "the value " << static_cast<long>(value) << " of an enum has no name");
  return "";
}

/// The value of a name. Throws CheckError for an unknown name.
template <NamedEnum Enum>
Enum choice_value(const std::string& name) {
  for (const Choice<Enum>& choice : choice_table<Enum>)
    if (choice.name == name) return choice.value;
  HOLDFAST_CHECK(false, "no value of an enum has the name '" << name << "'");
  return choice_table<Enum>[0].value;
}

/// All names, in order.
template <NamedEnum Enum>
std::vector<std::string> choice_names() {
  std::vector<std::string> names;
  for (const Choice<Enum>& choice : choice_table<Enum>) names.emplace_back(choice.name);
  return names;
}

}  // namespace holdfast
