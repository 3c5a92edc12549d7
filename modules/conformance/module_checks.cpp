// SPDX-License-Identifier: BSD-3-Clause
// Checks of every module: it can be constructed, and its reference is complete.
#include <gtest/gtest.h>

#include <set>

#include "check.hpp"

namespace holdfast::conformance {

namespace {

bool is_a_key(const std::string& name) {
  if (name.empty()) return false;
  for (const char c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_')) return false;
  return true;
}

void is_made(const Maker& maker) {
  EXPECT_NE(maker.make<Module>(), nullptr) << "the factory gave nothing";
  EXPECT_NE(maker.make<Module>(), nullptr) << "the factory gave nothing the second time";
  const auto one = maker.make<Module>(), two = maker.make<Module>();
  EXPECT_NE(one.get(), two.get()) << "the factory gave the same instance twice";
}

void is_described(const Maker& maker) {
  const ModuleDescription& description = maker.entry().description;
  EXPECT_TRUE(is_a_key(description.name)) << "found '" << description.name << "'";
  EXPECT_NE(description.summary, "") << "a summary is what `holdfast modules` shows";
  EXPECT_NE(description.licence, "");
}

void parameters_are_described(const Maker& maker) {
  std::set<std::string> names;
  for (const Parameter& parameter : maker.entry().parameters) {
    EXPECT_TRUE(is_a_key(parameter.name)) << "found the parameter '" << parameter.name << "'";
    EXPECT_TRUE(names.insert(parameter.name).second) << "'" << parameter.name << "' stands in the table twice";
    EXPECT_NE(parameter.help, "") << "'" << parameter.name << "' has no help";
    if (parameter.is_required) continue;
    const auto reason = parameter.reject(parameter.default_value);
    EXPECT_FALSE(reason) << "the default of '" << parameter.name << "' fails its own check: " << *reason;
  }
}

}  // namespace

std::vector<Check> module_checks() {
  return {
      {"IsMade",
       {"holdfast/plugin/registry.hpp",
        "A registered module: its description, its parameter table and its factory function."},
       is_made},
      {"IsDescribed",
       {"holdfast/plugin/registry.hpp", "key in the configuration: lower case, words joined by _"},
       is_described},
      {"ParametersAreDescribed",
       {"holdfast/plugin/parameter.hpp",
        "The same row gives the default, the checks and the reference that `holdfast modules` prints."},
       parameters_are_described},
  };
}

}  // namespace holdfast::conformance
