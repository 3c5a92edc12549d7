// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/fake_registry.hpp"

namespace holdfast {
namespace {

using test::complaints;
using test::EverySettings;
using test::load;
using test::rest;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string base = rest + "features: { orb: { count: 500, text: old } }\n";

EverySettings orb(const std::vector<std::string>& overrides) {
  return ParameterTable<EverySettings>().settings(load(base, overrides).features.values);
}

TEST(Overrides, SetValues) {
  const EverySettings s = orb({"features.orb.count=700", "features.orb.flag=false", "features.orb.scale=1.5"});
  EXPECT_EQ(s.count, 700);
  EXPECT_FALSE(s.flag);
  EXPECT_EQ(s.scale, 1.5);
  EXPECT_EQ(s.text, "old");
  EXPECT_EQ(orb({"features.orb.count=600", "features.orb.count=700"}).count, 700);  // the last one wins
}

TEST(Overrides, ValuesAreYaml) {
  EXPECT_EQ(orb({"features.orb.text=a=b, c d"}).text, "a=b, c d");
  EXPECT_EQ(orb({"features.orb.text='x: y'"}).text, "x: y");
  EXPECT_THAT(orb({"features.orb.words=[a, b c]"}).words, ElementsAre("a", "b c"));
  EXPECT_THAT(orb({"features.orb.numbers=[1,2.5]"}).numbers, ElementsAre(1.0, 2.5));
  EXPECT_EQ(orb({"features={ orb: { count: 800 } }"}).count, 800);
  EXPECT_EQ(orb({"features={ orb: { count: 800 } }"}).text, "plain");  // the whole section is new
}

TEST(Overrides, ReplaceAChoice) {
  EXPECT_EQ(load(base, {"features=opencv_orb"}).features.name, "opencv_orb");
  EXPECT_EQ(load(base, {"features.opencv_orb={}"}).features.name, "opencv_orb");
  const Configuration still = load(base, {"source.still="});
  EXPECT_EQ(still.source.name, "still");
  const Configuration back = load(base, {"features=opencv_orb", "features.orb.count=90"});
  EXPECT_EQ(back.features.name, "orb");
  EXPECT_EQ(std::get<std::int64_t>(back.features.values.at("count")), 90);
  EXPECT_EQ(std::get<std::string>(back.features.values.at("text")), "plain");
  // A shorthand grows parameters.
  const std::string shorthand = rest + "features: orb\n";
  EXPECT_EQ(std::get<std::int64_t>(load(shorthand, {"features.orb.count=90"}).features.values.at("count")), 90);
}

TEST(Overrides, MakeMissingSections) {
  EXPECT_EQ(load(base, {"run.seed=9"}).run.seed, 9U);
  EXPECT_EQ(load(base, {"camera=tum_fr2"}).camera, find_camera("tum_fr2"));
  EXPECT_EQ(load(base, {"filters=[semantic_mask]"}).filters.size(), 1U);
  EXPECT_EQ(std::get<double>(load(base, {"tracking.threshold=2"}).sections.at("tracking").at("threshold")), 2.0);
  EXPECT_EQ(load("run: {}\n", {"source.tum.path=/x", "features=orb", "optimizer=ceres"}).features.name, "orb");
}

TEST(Overrides, NameElementsByNumber) {
  const std::string chain = base + "filters: [ semantic_mask, reprojection_error: { threshold: 3 } ]\n";
  EXPECT_EQ(
      std::get<double>(load(chain, {"filters.1.reprojection_error.threshold=4"}).filters.at(1).values.at("threshold")),
      4.0);
  EXPECT_EQ(load(chain, {"filters.1=semantic_mask"}).filters.at(1).name, "semantic_mask");
  // Another name takes the link's place, as in a section that chooses.
  const Configuration replaced =
      load(chain, {"filters.0.reprojection_error.threshold=7", "filters.1.semantic_mask={}"});
  EXPECT_EQ(std::get<double>(replaced.filters.at(0).values.at("threshold")), 7.0);
  EXPECT_EQ(replaced.filters.at(1).name, "semantic_mask");
}

TEST(Overrides, ElementsThatAreNotThere) {
  const std::string chain = base + "filters: [ semantic_mask, semantic_mask ]\n";
  EXPECT_EQ(
      complaints(chain, {"filters.2=semantic_mask"}),
      "--set filters.2=semantic_mask: '2' is no element of the list, which has 2; expected a number from 0 to 1\n");
  EXPECT_THAT(complaints(chain, {"filters.semantic_mask.x=1"}), HasSubstr("'semantic_mask' is no element of the list"));
  EXPECT_THAT(complaints(chain, {"filters.-1=semantic_mask"}), HasSubstr("'-1' is no element of the list"));
  EXPECT_EQ(complaints(base + "filters: []\n", {"filters.0=semantic_mask"}),
            "--set filters.0=semantic_mask: '0' is no element of the list, which is empty; set the whole list: "
            "filters=[ ... ]\n");
}

TEST(Overrides, BadSyntaxIsToldForAllOfThem) {
  EXPECT_EQ(complaints(base, {"count", "=5", "a..b=1", "run.seed=2"}),
            "--set count: expected key.path=value, such as features.orb.count=500\n"
            "--set =5: expected key.path=value, such as features.orb.count=500\n"
            "--set a..b=1: the key has an empty part; expected key.path=value, such as features.orb.count=500\n");
  EXPECT_THAT(complaints(base, {"features.orb.words=[a"}),
              AllOf(StartsWith("--set features.orb.words=[a"), HasSubstr("syntax error")));
}

TEST(Overrides, MistakesNameTheOverride) {
  EXPECT_EQ(complaints(base, {"features.orb.cuont=5"}),
            "--set features.orb.cuont=5: features 'orb' has no parameter 'cuont'; did you mean 'count'?\n");
  EXPECT_THAT(complaints(base, {"features.orb.count=many"}),
              StartsWith("--set features.orb.count=many: found 'many' for 'count'"));
  EXPECT_THAT(complaints(base, {"feature.orb.count=5"}),
              StartsWith("--set feature.orb.count=5: there is no section 'feature'; did you mean 'features'?"));
  EXPECT_THAT(complaints(base, {"source.tum.path="}),
              StartsWith("--set source.tum.path=: found nothing for 'path' of source 'tum'"));
}

}  // namespace
}  // namespace holdfast
