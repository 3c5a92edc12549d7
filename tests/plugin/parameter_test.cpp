// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/parameter_table.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace holdfast {

enum class Interpolation { nearest, linear };
template <>
inline constexpr Choice<Interpolation> choice_table<Interpolation>[] = {{"nearest", Interpolation::nearest},
                                                                        {"linear", Interpolation::linear}};

namespace {

struct Settings {
  bool on = true;
  int count = 1000;
  std::uint8_t level = 8;
  float ratio = 0.1F;
  double sigma = 1.5;
  std::string mode = "fast";
  Interpolation interpolation = Interpolation::linear;
  std::filesystem::path model;
  std::vector<std::string> classes{"person"};
  std::vector<double> weights{1, 0.5};
  TextMap names{{"b", "2"}, {"a", "1"}};
  RealTable places{{1, 2}, {3.5, 4}};
  RealMap shares{{"b", 0.25}, {"a", 1}};

  static void describe(ParameterTable<Settings>& table) {
    using S = Settings;
    table.add("on", &S::on, "");
    table.add("count", &S::count, "features to keep").range(50, 20000);
    table.add("level", &S::level, "");
    table.add("ratio", &S::ratio, "");
    table.add("sigma", &S::sigma, "").at_least(0).unit("px");
    table.add("mode", &S::mode, "").one_of({"fast", "exact"});
    table.add("interpolation", &S::interpolation, "");
    table.add("model", &S::model, "").required();
    table.add("classes", &S::classes, "").one_of({"person", "cat"});
    table.add("weights", &S::weights, "").at_most(1);
    table.add("names", &S::names, "");
    table.add("places", &S::places, "").at_least(-9).unit("m");
    table.add("shares", &S::shares, "").range(0, 1);
  }
};

Parameter parameter(const std::string& name) {
  for (const Parameter& p : ParameterTable<Settings>().parameters())
    if (p.name == name) return p;
  throw std::out_of_range(name);
}

TEST(ParameterTable, GoesThroughValuesAndBack) {
  const ParameterTable<Settings> table;
  Settings written;
  written.on = false;
  written.count = 77;
  written.level = 255;
  written.ratio = 0.3F;
  written.sigma = 1.0 / 3;
  written.mode = "exact";
  written.interpolation = Interpolation::nearest;
  written.model = "/models/a.onnx";
  written.classes = {"cat", "person"};
  written.weights = {};
  written.names = {{"x", "y"}};
  written.places = {{0.5}, {}};
  const Settings read = table.settings(table.values(written));
  EXPECT_EQ(read.on, written.on);
  EXPECT_EQ(read.count, written.count);
  EXPECT_EQ(read.level, written.level);
  EXPECT_EQ(read.ratio, written.ratio);
  EXPECT_EQ(read.sigma, written.sigma);
  EXPECT_EQ(read.mode, written.mode);
  EXPECT_EQ(read.interpolation, written.interpolation);
  EXPECT_EQ(read.model, written.model);
  EXPECT_EQ(read.classes, written.classes);
  EXPECT_EQ(read.weights, written.weights);
  EXPECT_EQ(read.names, written.names);
  EXPECT_EQ(read.places, written.places);
}

TEST(ParameterTable, AnEnumIsAChoiceOfNames) {
  const Parameter row = parameter("interpolation");
  EXPECT_EQ(row.type, ParameterType::text);
  EXPECT_EQ(std::get<std::string>(row.default_value), "linear");
  EXPECT_EQ(row.expectation(), "one of nearest, linear");
  EXPECT_FALSE(row.reject(std::string("nearest")));
  EXPECT_EQ(row.reject(std::string("cubic")), "'cubic' is not among them");
  EXPECT_THROW(choice_value<Interpolation>("cubic"), CheckError);
  EXPECT_THROW(choice_name(static_cast<Interpolation>(7)), CheckError);
}

TEST(ParameterTable, WhatIsNotGivenKeepsItsDefault) {
  const Settings settings = ParameterTable<Settings>().settings({{"count", std::int64_t{60}}});
  EXPECT_EQ(settings.count, 60);
  EXPECT_EQ(settings.mode, "fast");
  EXPECT_EQ(settings.level, 8);
}

TEST(Parameter, SaysWhatIsExpected) {
  EXPECT_EQ(parameter("on").expectation(), "true or false");
  EXPECT_EQ(parameter("count").expectation(), "an integer from 50 to 20000");
  EXPECT_EQ(parameter("sigma").expectation(), "a number of at least 0 [px]");
  EXPECT_EQ(parameter("mode").expectation(), "one of fast, exact");
  EXPECT_EQ(parameter("weights").expectation(), "a list of numbers, each of at most 1");
  EXPECT_EQ(parameter("places").expectation(), "a list of lists of numbers, each of at least -9 [m]");
  EXPECT_EQ(parameter("shares").expectation(), "a map from names to numbers, each from 0 to 1");
  EXPECT_TRUE(parameter("model").is_required);
}

TEST(Parameter, RejectsWhatIsOutOfRange) {
  EXPECT_EQ(parameter("count").reject(std::int64_t{50}), std::nullopt);
  EXPECT_EQ(parameter("count").reject(std::int64_t{49}), "49 is below 50");
  EXPECT_EQ(parameter("count").reject(std::int64_t{20001}), "20001 is above 20000");
  EXPECT_EQ(parameter("sigma").reject(std::numeric_limits<double>::infinity()), ".inf is not finite");
  EXPECT_EQ(parameter("sigma").reject(std::numeric_limits<double>::quiet_NaN()), ".nan is not finite");
  EXPECT_EQ(parameter("mode").reject(std::string("slow")), "'slow' is not among them");
  EXPECT_EQ(parameter("weights").reject(std::vector<double>{0.5, 7}), "7 is above 1");
  EXPECT_EQ(parameter("places").reject(RealTable{{1, 2}, {3, -10}}), "-10 is below -9");
  EXPECT_EQ(parameter("shares").reject(RealMap{{"a", 1}, {"b", 1.5}}), "'b': 1.5 is above 1");
  EXPECT_EQ(parameter("shares").reject(RealMap{}), std::nullopt);
  EXPECT_EQ(parameter("classes").reject(std::vector<std::string>{"person", "dog"}), "'dog' is not among them");
}

TEST(Parameter, RejectsWhatTheMemberCannotHold) {
  EXPECT_EQ(parameter("level").reject(std::int64_t{255}), std::nullopt);
  EXPECT_NE(parameter("level").reject(std::int64_t{256}), std::nullopt);
  EXPECT_NE(parameter("level").reject(std::int64_t{-1}), std::nullopt);
}

TEST(Parameter, RejectsAnotherType) { EXPECT_EQ(parameter("count").reject(2.5), "2.5 is no integer"); }

TEST(ParameterValue, IsWrittenAsYaml) {
  EXPECT_EQ(to_string(ParameterValue(true)), "true");
  EXPECT_EQ(to_string(ParameterValue(std::int64_t{-3})), "-3");
  EXPECT_EQ(to_string(ParameterValue(5.0)), "5.0") << "a real stays visibly one";
  EXPECT_EQ(to_string(ParameterValue(0.1)), "0.1");
  EXPECT_EQ(to_string(parameter("ratio").default_value), "0.1") << "a float shows what was written";
  EXPECT_EQ(to_string(ParameterValue(std::string("person"))), "person");
  EXPECT_EQ(to_string(ParameterValue(std::string("../data/fr1"))), "../data/fr1");
  EXPECT_EQ(to_string(parameter("weights").default_value), "[1.0, 0.5]");
  EXPECT_EQ(to_string(parameter("places").default_value), "[[1.0, 2.0], [3.5, 4.0]]");
  EXPECT_EQ(to_string(parameter("names").default_value), "{b: \"2\", a: \"1\"}");
}

TEST(ParameterValue, QuotesTextsThatYamlWouldReadOtherwise) {
  for (const std::string text : {"", "5", "true", "No", "null", "~", "a: b", "#x", ".inf", "[a]", "two words", "- a"})
    EXPECT_EQ(to_string(ParameterValue(text)), '"' + text + '"');
  EXPECT_EQ(to_string(ParameterValue(std::string("a\"b\\n\x01"))), R"("a\"b\\n\x01")");
}

}  // namespace
}  // namespace holdfast
