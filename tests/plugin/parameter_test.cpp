// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/registry.hpp"
#include "plugin/number.hpp"

namespace holdfast {
namespace {

struct Settings {
  bool flag = false;
  unsigned count = 3;
  std::int8_t small = -1;
  float ratio = 0.1F;
  double scale = 2.5;
  std::string text = "a";
  std::filesystem::path file = "/f";
  std::vector<std::string> words = {"x"};
  std::vector<double> numbers = {1};
  TextMap pairs = {{"k", "v"}};

  static void describe(ParameterTable<Settings>& table) {
    using S = Settings;
    table.add("flag", &S::flag, "");
    table.add("count", &S::count, "");
    table.add("small", &S::small, "").at_most(5);
    table.add("ratio", &S::ratio, "").unit("m");
    table.add("scale", &S::scale, "").range(1, 3);
    table.add("text", &S::text, "").one_of({"a", "b"});
    table.add("file", &S::file, "");
    table.add("words", &S::words, "").one_of({"x", "y"});
    table.add("numbers", &S::numbers, "").at_least(0);
    table.add("pairs", &S::pairs, "");
  }
};

TEST(ParameterTable, SettingsAndValuesAreTheSameThing) {
  const ParameterTable<Settings> table;
  const Settings given{true, 9, 4, 0.7F, 1.25, "b", "/g", {"y", "x"}, {0, 2}, {{"a", "b"}, {"c", "d"}}};
  const ParameterValues values = table.values(given);
  EXPECT_EQ(values.size(), 10U);
  EXPECT_EQ(table.values(table.settings(values)), values);
  const Settings back = table.settings(values);
  EXPECT_EQ(back.flag, true);
  EXPECT_EQ(back.count, 9U);
  EXPECT_EQ(back.small, 4);
  EXPECT_EQ(back.ratio, 0.7F);
  EXPECT_EQ(back.scale, 1.25);
  EXPECT_EQ(back.text, "b");
  EXPECT_EQ(back.file, "/g");
  EXPECT_EQ(back.words, given.words);
  EXPECT_EQ(back.numbers, given.numbers);
  EXPECT_EQ(back.pairs, given.pairs);
}

TEST(ParameterTable, WhatIsNotGivenKeepsItsDefault) {
  const ParameterTable<Settings> table;
  const Settings settings = table.settings({{"count", std::int64_t{7}}});
  EXPECT_EQ(settings.count, 7U);
  EXPECT_EQ(settings.scale, 2.5);
  for (const Parameter& parameter : table.parameters()) {
    EXPECT_EQ(parameter.default_value, table.values(Settings{}).at(parameter.name)) << parameter.name;
    EXPECT_FALSE(parameter.reject(parameter.default_value).has_value()) << parameter.name;
  }
}

TEST(Parameter, RejectsWhatTheMemberCannotHold) {
  const std::vector<Parameter> rows = ParameterTable<Settings>().parameters();
  const auto rejects = [&](std::size_t row, const ParameterValue& value) {
    return rows[row].reject(value).has_value();
  };
  EXPECT_TRUE(rejects(1, std::int64_t{-1}));
  EXPECT_TRUE(rejects(1, std::int64_t{4294967296}));
  EXPECT_FALSE(rejects(1, std::int64_t{4294967295}));
  EXPECT_TRUE(rejects(2, std::int64_t{-129}));
  EXPECT_TRUE(rejects(2, std::int64_t{6}));
  EXPECT_FALSE(rejects(2, std::int64_t{-128}));
  EXPECT_TRUE(rejects(4, 3.0000001));
  EXPECT_TRUE(rejects(4, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(rejects(4, std::int64_t{2}));  // another type
  EXPECT_TRUE(rejects(5, std::string("c")));
  EXPECT_TRUE(rejects(7, std::vector<std::string>{"x", "z"}));
  EXPECT_TRUE(rejects(8, std::vector<double>{1, -1}));
}

TEST(Parameter, SaysWhatItExpects) {
  const std::vector<Parameter> rows = ParameterTable<Settings>().parameters();
  EXPECT_EQ(rows[0].expectation(), "true or false");
  EXPECT_EQ(rows[2].expectation(), "an integer of at most 5");
  EXPECT_EQ(rows[3].expectation(), "a number [m]");
  EXPECT_EQ(rows[4].expectation(), "a number from 1 to 3");
  EXPECT_EQ(rows[5].expectation(), "one of a, b");
  EXPECT_EQ(rows[8].expectation(), "a list of numbers, each of at least 0");
}

TEST(ShortestDouble, ShowsWhatWasWrittenAndGoesBack) {
  for (float number : {0.1F, 0.7F, 1e-20F, 3.4e38F, 16777217.0F, -0.3F, 0.0F})
    EXPECT_EQ(static_cast<float>(shortest_double(number)), number);
  EXPECT_EQ(shortest_double(0.1F), 0.1);
}

TEST(DidYouMean, CountsEdits) {
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("count", "cuont"), 1);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("same", "same"), 0);
}

TEST(DidYouMean, NamesTheNearestOrAll) {
  const std::vector<std::string> known = {"count", "levels", "scale_factor"};
  EXPECT_EQ(nearest_name("cuont", known), "count");
  EXPECT_EQ(nearest_name("Scale-Factor", known), "scale_factor");
  EXPECT_EQ(nearest_name("sca", known), "scale_factor");
  EXPECT_EQ(nearest_name("banana", known), std::nullopt);
  EXPECT_EQ(did_you_mean("level", known), "did you mean 'levels'?");
  EXPECT_EQ(did_you_mean("banana", known), "known are count, levels, scale_factor");
  EXPECT_EQ(did_you_mean("banana", {}), "none is known");
}

class One final : public test::Number {
 public:
  One(const NoSettings&, const CreationContext&) {}
  double number() const override { return 1; }
};

TEST(Registry, KnowsModulesByKindAndName) {
  Registry registry;
  registry.add<test::Number, One, NoSettings>({.name = "one"});
  registry.add<test::Number, One, NoSettings>({.name = "another"});
  EXPECT_THAT(registry.kinds(), ::testing::ElementsAre("number"));
  EXPECT_THAT(registry.names("number"), ::testing::ElementsAre("another", "one"));
  EXPECT_THAT(registry.names("nobody"), ::testing::IsEmpty());
  EXPECT_EQ(registry.find("number", "two"), nullptr);
  EXPECT_EQ(registry.create<test::Number>("one", {}, {})->number(), 1);
  EXPECT_THROW((registry.add<test::Number, One, NoSettings>({.name = "one"})), PluginError);
  try {
    registry.create<test::Number>("oen", {}, {});
    FAIL();
  } catch (const PluginError& error) {
    EXPECT_STREQ(error.what(), "no number module is called 'oen'; did you mean 'one'?");
  }
}

}  // namespace
}  // namespace holdfast
