// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "fixture.hpp"

namespace holdfast {
namespace {

using test::problems;
using test::resolve;
using testing::ElementsAre;
using testing::StartsWith;

TEST(Override, SetsAndMakes) {
  const Configuration c = resolve(test::good, {"features.orb.count=700", "run.seed=9", "tracking.window=3.5"});
  EXPECT_EQ(c.features.values.at("count"), ParameterValue(std::int64_t{700}));
  EXPECT_EQ(c.run.seed, 9U);
  EXPECT_EQ(c.sections.at("tracking").at("window"), ParameterValue(3.5));
}

TEST(Override, TheLastOneCounts) { EXPECT_EQ(resolve(test::good, {"run.seed=9", "run.seed=10"}).run.seed, 10U); }

TEST(Override, AnotherModuleReplacesTheChoice) {
  const Configuration c = resolve(test::good, {"features.opencv_orb.scale=1.5", "features.opencv_orb.even=false"});
  EXPECT_EQ(c.features.name, "opencv_orb");
  EXPECT_EQ(c.features.values.at("count"), ParameterValue(std::int64_t{1000})) << "not what orb was given";
  EXPECT_EQ(c.features.values.at("scale"), ParameterValue(1.5));
  EXPECT_EQ(c.features.values.at("even"), ParameterValue(false));
  EXPECT_EQ(resolve(test::good, {"features=opencv_orb"}).features.name, "opencv_orb");
}

TEST(Override, ReachesIntoLists) {
  const std::string text = test::good + "filters: [ semantic_mask, semantic_mask: { weights: [ 1, 1 ] } ]\n";
  const Configuration c =
      resolve(text, {"filters.0.semantic_mask.classes=[cat, person]", "filters.1.semantic_mask.weights.1=0.5"});
  EXPECT_EQ(c.filters[0].values.at("classes"), ParameterValue(std::vector<std::string>{"cat", "person"}));
  EXPECT_EQ(c.filters[1].values.at("weights"), ParameterValue(std::vector<double>{1, 0.5}));
  EXPECT_THAT(
      problems(text, {"filters.2=semantic_mask"}),
      ElementsAre("--set filters.2=semantic_mask: '2' is no element of the list; expected a number from 0 to 1"));
  EXPECT_THAT(problems(test::good + "filters: []\n", {"filters.0=semantic_mask"}),
              ElementsAre("--set filters.0=semantic_mask: '0' is no element of the list, which is empty"));
}

TEST(Override, AListThatIsNotThereHasNoElements) {
  EXPECT_THAT(problems(test::good, {"filters.0=semantic_mask"}),
              ElementsAre("--set filters.0=semantic_mask: 'filters' has no element 0 to set; expected the whole list, "
                          "such as filters=[a, b]"));
}

TEST(Override, IsNamedAsThePlaceOfAnError) {
  EXPECT_THAT(
      problems(test::good, {"features.orb.count=abc"}),
      ElementsAre("--set features.orb.count=abc: found 'abc' for 'count' of features 'orb'; expected an integer "
                  "from 50 to 20000"));
  EXPECT_THAT(
      problems(test::good, {"features.orb.cuont=500"}),
      ElementsAre("--set features.orb.cuont=500: features 'orb' has no parameter 'cuont'; did you mean 'count'?"));
}

TEST(Override, RefusesWhatIsNoOverride) {
  for (const std::string text : {"features", "=5", "features..count=5"})
    EXPECT_THAT(problems(test::good, {text}), ElementsAre(StartsWith("--set " + text + ": "))) << text;
  EXPECT_THAT(problems(test::good, {"run.seed=[1"}), ElementsAre(testing::HasSubstr("syntax error")));
}

}  // namespace
}  // namespace holdfast
