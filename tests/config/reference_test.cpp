// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/reference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "config/fake_registry.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string reference_of(const std::string& name, ReferenceFormat format) {
  return reference(test::fake_registry(), test::fake_sections(), name, format);
}

/// Calls function(kind, name, parameters) for all that can be said.
template <class Function>
void for_each_entry(Function function) {
  const Registry registry = test::fake_registry();
  for (const std::string& kind : registry.kinds())
    for (const ModuleEntry* entry : registry.of_kind(kind)) function(kind, entry->description.name, entry->parameters);
  for (const SectionDescription& section : test::fake_sections()) function("section", section.name, section.parameters);
  function("section", "camera", ParameterTable<CameraSettings>().parameters());
  function("section", "run", ParameterTable<RunSettings>().parameters());
}

TEST(Reference, ListsEverything) {
  const std::string brief = reference_of("", ReferenceFormat::text);
  const std::string markdown = reference_of("", ReferenceFormat::markdown);
  const auto json = nlohmann::json::parse(reference_of("", ReferenceFormat::json));
  std::size_t entries = 0;
  for_each_entry([&](const std::string& kind, const std::string& name, const std::vector<Parameter>& parameters) {
    ++entries;
    EXPECT_THAT(brief, HasSubstr("\n  " + name + " "));
    EXPECT_THAT(markdown, HasSubstr("\n### `" + name + "`\n"));
    const auto found =
        std::find_if(json.begin(), json.end(), [&](const auto& e) { return e["kind"] == kind && e["name"] == name; });
    ASSERT_NE(found, json.end()) << kind << ' ' << name;
    ASSERT_EQ((*found)["parameters"].size(), parameters.size());
    const std::string full = reference_of(name, ReferenceFormat::text);
    EXPECT_THAT(full, HasSubstr(kind + ": " + name + "\n"));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Parameter& p = parameters[i];
      EXPECT_THAT(full, HasSubstr("    " + p.name));
      EXPECT_THAT(full, HasSubstr(p.help));
      EXPECT_THAT(markdown, HasSubstr("| `" + p.name + "` | " + to_string(p.type) + " | "));
      EXPECT_EQ((*found)["parameters"][i]["name"], p.name);
      EXPECT_EQ((*found)["parameters"][i]["type"], to_string(p.type));
      EXPECT_EQ((*found)["parameters"][i]["help"], p.help);
      EXPECT_EQ((*found)["parameters"][i]["required"], p.is_required);
    }
  });
  EXPECT_EQ(json.size(), entries);
}

TEST(Reference, SaysWhatTheTableSays) {
  const std::string full = reference_of("orb", ReferenceFormat::text);
  EXPECT_THAT(full, HasSubstr("Paper: Nobody 2001"));
  EXPECT_THAT(full, HasSubstr("Licence: BSD-3-Clause; built in"));
  EXPECT_THAT(full, HasSubstr("integer, default 1000, from 50 to 20000"));
  EXPECT_THAT(full, HasSubstr("default 1.2 [m], from 1.01 to 4"));
  EXPECT_THAT(full, HasSubstr("red | green"));
  EXPECT_THAT(reference_of("tum", ReferenceFormat::text), HasSubstr("path, required"));
  const auto json = nlohmann::json::parse(reference_of("orb", ReferenceFormat::json));
  const auto& count = json.at(0).at("parameters").at(1);
  EXPECT_EQ(count.at("default"), 1000);
  EXPECT_EQ(count.at("minimum"), 50);
  EXPECT_EQ(count.at("maximum"), 20000);
  const auto& pairs = json.at(0).at("parameters").at(10);
  EXPECT_EQ(pairs.at("default"), nlohmann::json({{"key", "value"}}));
}

TEST(Reference, TablesInMarkdownStayTables) {
  std::istringstream stream(reference_of("", ReferenceFormat::markdown));
  int rows = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.front() != '|') continue;
    ++rows;
    int bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\') ? 1 : 0;
    EXPECT_EQ(bars, 7) << line;
  }
  EXPECT_GT(rows, 20);
}

TEST(Reference, NarrowsToANameOrAKind) {
  const std::string source = reference_of("source", ReferenceFormat::text);
  EXPECT_THAT(source, HasSubstr("source: tum\n"));
  EXPECT_THAT(source, HasSubstr("source: still\n"));
  EXPECT_THAT(source, Not(HasSubstr("features: orb")));
  EXPECT_EQ(nlohmann::json::parse(reference_of("none", ReferenceFormat::json)).size(), 2U);  // of two kinds
  EXPECT_THAT(reference_of("camera", ReferenceFormat::text), HasSubstr("tum_fr1"));
}

TEST(Reference, UnknownNames) {
  const auto message = [](const std::string& name) -> std::string {
    try {
      reference_of(name, ReferenceFormat::markdown);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("obr"), "there is no module or section 'obr'; did you mean 'orb'?");
  EXPECT_EQ(message("trakcing"), "there is no module or section 'trakcing'; did you mean 'tracking'?");
  EXPECT_THAT(message("qqqqqqqqq"), HasSubstr("known are camera, ceres, "));
}

}  // namespace
}  // namespace holdfast
