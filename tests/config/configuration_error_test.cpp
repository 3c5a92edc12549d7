// SPDX-License-Identifier: BSD-3-Clause
// Every way to be wrong, with its exact place and words.
#include <gmock/gmock.h>

#include "fixture.hpp"

namespace holdfast {
namespace {

using test::problems;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// The good configuration with other features.
std::string with_features(const std::string& features) {
  return "source: { tum: { path: fr1 } }\ncamera: tum_fr1\nfeatures: " + features + "\noptimizer: ceres\n";
}

TEST(ConfigurationErrors, AGoodOneHasNone) { EXPECT_THAT(problems(test::good), IsEmpty()); }

TEST(ConfigurationErrors, UnknownSection) {
  EXPECT_THAT(problems(test::good + "traking: {}\n"),
              ElementsAre("c.yaml:5:1: there is no section 'traking'; did you mean 'tracking'?"));
}

TEST(ConfigurationErrors, UnknownModule) {
  EXPECT_THAT(problems(with_features("{ obr: {} }")),
              ElementsAre("c.yaml:3:13: there is no features module 'obr'; did you mean 'orb'?"));
  EXPECT_THAT(problems(with_features("sift")),
              ElementsAre("c.yaml:3:11: there is no features module 'sift'; known are opencv_orb, orb"));
}

TEST(ConfigurationErrors, UnknownParameter) {
  EXPECT_THAT(problems(with_features("{ orb: { cuont: 500 } }")),
              ElementsAre("c.yaml:3:20: features 'orb' has no parameter 'cuont'; did you mean 'count'?"));
}

/// A user who finds a parameter in the reference may write it in the wrong section.
TEST(ConfigurationErrors, AParameterOfAnotherSectionIsAnsweredWithIt) {
  const std::string window = "c.yaml:3:20: features 'orb' has no parameter 'window'; it is `tracking.window`";
  EXPECT_THAT(problems(with_features("{ orb: { window: 5 } }")), ElementsAre(window));
  EXPECT_THAT(problems(test::good, {"camera={name: tum_fr1, count: 500}"}),
              ElementsAre(HasSubstr("section 'camera' has no parameter 'count'; it is `features.orb.count`")));
  EXPECT_THAT(problems(test::good + "count: 500\n"),
              ElementsAre("c.yaml:5:1: there is no section 'count'; it is `features.orb.count`"));
}

TEST(ConfigurationErrors, AMovedKeyNamesItsNewPlace) {
  std::vector<SectionDescription> sections = test::test_sections();
  sections.push_back({"mapping", "How the map is made.", {}});
  const ConfigurationNode root = parse_yaml(test::good + "mapping: { close_depth_factor: 30, x: 1 }\n", "c.yaml", "/");
  Registry registry = test::test_registry();
  try {
    resolve_configuration(root, "c.yaml", registry, sections);
    FAIL();
  } catch (const ConfigurationError& error) {
    ASSERT_EQ(error.diagnostics().size(), 2U);
    EXPECT_EQ(error.diagnostics()[0].to_string(),
              "c.yaml:5:12: 'close_depth_factor' of section 'mapping' is now 'tracking.close_depth_factor'");
    EXPECT_THAT(error.diagnostics()[1].to_string(), testing::HasSubstr("has no parameter 'x'"));
  }
}

TEST(ConfigurationErrors, WrongType) {
  EXPECT_THAT(
      problems(with_features("{ orb: { count: 3.5 } }")),
      ElementsAre("c.yaml:3:27: found '3.5' for 'count' of features 'orb'; expected an integer from 50 to 20000"));
  EXPECT_THAT(problems(with_features("{ orb: { count: '500' } }")), ElementsAre(StartsWith("c.yaml:3:27: found")));
  EXPECT_THAT(problems(with_features("{ orb: { count: 99999999999999999999 } }")),
              ElementsAre(StartsWith("c.yaml:3:27: found")));
  EXPECT_THAT(problems(with_features("{ orb: { even: yes } }")),
              ElementsAre("c.yaml:3:26: found 'yes' for 'even' of features 'orb'; expected true or false"));
  EXPECT_THAT(problems(with_features("{ orb: { scale: fast } }")),
              ElementsAre("c.yaml:3:27: found 'fast' for 'scale' of features 'orb'; expected a number from 1.01 to 2"));
  EXPECT_THAT(problems(with_features("{ orb: { scale: .nan } }")), ElementsAre(StartsWith("c.yaml:3:27: found")));
  EXPECT_THAT(problems(with_features("{ orb: { count: } }")), ElementsAre(testing::HasSubstr("found nothing")));
  EXPECT_THAT(problems(with_features("{ orb: [ 5 ] }")),
              ElementsAre(StartsWith("c.yaml:3:18: found a list; expected the parameters of features 'orb'")));
}

TEST(ConfigurationErrors, OutOfRange) {
  EXPECT_THAT(problems(with_features("{ orb: { count: 49 } }")),
              ElementsAre("c.yaml:3:27: found '49' for 'count' of features 'orb': 49 is below 50; expected an integer "
                          "from 50 to 20000"));
  EXPECT_THAT(problems(with_features("{ orb: { spread: treee } }")),
              ElementsAre("c.yaml:3:28: found 'treee' for 'spread' of features 'orb': 'treee' is not among them; "
                          "expected one of tree, grid"));
}

TEST(ConfigurationErrors, MissingParameter) {
  EXPECT_THAT(problems("source: tum\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n"),
              ElementsAre("c.yaml:1:9: source 'tum' needs 'path' (folder of the recording); expected a path"));
}

TEST(ConfigurationErrors, MissingSections) {
  EXPECT_THAT(problems("camera: tum_fr1\n"),
              ElementsAre("c.yaml: section 'source' is missing; expected one module; known are tum",
                          "c.yaml: section 'features' is missing; expected one module; known are opencv_orb, orb",
                          "c.yaml: section 'optimizer' is missing; expected one module; known are ceres"));
}

TEST(ConfigurationErrors, TwoModulesInAChoice) {
  EXPECT_THAT(
      problems(with_features("{ orb: {}, opencv_orb: {} }")),
      ElementsAre(StartsWith("c.yaml:3:11: found 2 keys (orb, opencv_orb) for 'features'; expected one module")));
  EXPECT_THAT(problems(with_features("{}")), ElementsAre(StartsWith("c.yaml:3:11: found 0 keys for 'features'")));
}

TEST(ConfigurationErrors, Chains) {
  EXPECT_THAT(problems(test::good + "filters: { semantic_mask: {} }\n"),
              ElementsAre(StartsWith("c.yaml:5:10: found a map for 'filters'; expected a list")));
  EXPECT_THAT(
      problems(test::good + "filters:\n  - semantic_mask: { weights: [ 0.5, 2 ] }\n  - semantic_msk\n"),
      ElementsAre("c.yaml:6:31: found a list for 'weights' of filters 'semantic_mask': 2 is above 1; expected a "
                  "list of numbers, each from 0 to 1",
                  "c.yaml:7:5: there is no filters module 'semantic_msk'; did you mean 'semantic_mask'?"));
}

TEST(ConfigurationErrors, Camera) {
  const std::string rest = "source: { tum: { path: fr1 } }\nfeatures: orb\noptimizer: ceres\n";
  EXPECT_THAT(problems(rest + "camera: tum_fr4\n"),
              ElementsAre(AllOf(StartsWith("c.yaml:4:9: there is no known camera 'tum_fr4'; "),
                                EndsWith("did you mean 'tum_fr1'?"))));
  EXPECT_THAT(problems(rest + "camera: { width: 640, height: 480, fx: 500, fy: 500, cx: 320, c: 240 }\n"),
              ElementsAre(StartsWith("c.yaml:4:9: section 'camera' needs 'cy' ("),
                          StartsWith("c.yaml:4:63: section 'camera' has no parameter 'c'")));
}

TEST(ConfigurationErrors, SequentialModeKeepsNoPace) {
  EXPECT_THAT(problems(test::good + "run: { mode: threaded, pace: timestamps }\n"), ElementsAre());
  EXPECT_THAT(problems(test::good + "run: { pace: timestamps }\n"),
              ElementsAre("c.yaml:5:14: found 'timestamps' for 'pace' of section 'run', which sequential mode cannot "
                          "keep; expected 'none', or 'threaded' for 'mode'"));
}

TEST(ConfigurationErrors, Plugins) {
  EXPECT_THAT(problems(test::good + "plugins: libmine.so\n"),
              ElementsAre("c.yaml:5:10: found 'libmine.so' for 'plugins'; expected a list of files"));
  EXPECT_THAT(problems(test::good + "plugins: [ sub/libmine.so, libabsent ]\n"),
              ElementsAre("c.yaml:5:12: plugin '/data/sub/libmine.so' cannot be loaded: there is no such file",
                          StartsWith("c.yaml:5:28: plugin 'libabsent' cannot be found; searched: /data, ")));
  EXPECT_THAT(problems(test::good + "plugins: [ " TEST_PLUGIN_FOLDER "/libtest_plugin_stranger.so ]\n"),
              ElementsAre(testing::HasSubstr("does not fit this program")));
}

TEST(ConfigurationErrors, AllAtOnceInTheOrderOfTheFile) {
  EXPECT_THAT(problems("tracking: { window: 500 }\nfeatures: { orb: { cuont: 1 } }\nsource: tun\nfoo: 1\n"),
              ElementsAre(StartsWith("c.yaml:1:21: found '500' for 'window' of section 'tracking'"),
                          StartsWith("c.yaml:2:20: features 'orb' has no parameter 'cuont'"),
                          StartsWith("c.yaml:3:9: there is no source module 'tun'; did you mean 'tum'?"),
                          StartsWith("c.yaml:4:1: there is no section 'foo'"),
                          StartsWith("c.yaml: section 'optimizer' is missing")));
}

}  // namespace
}  // namespace holdfast
