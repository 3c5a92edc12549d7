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

struct SupportSettings {
  int minimum_matches = 30;
  static void describe(ParameterTable<SupportSettings>& table) {
    table.add("minimum_matches", &SupportSettings::minimum_matches, "trusted matches").range(1, 1000);
  }
};

/// A configuration with sections and a filter whose parameters had other names before.
Configuration resolve_old_keys(const std::string& more, const std::vector<std::string>& overrides = {}) {
  Registry registry = test::test_registry();
  test::add<DynamicFilter, SupportSettings>(registry, "reprojection_error");
  std::vector<SectionDescription> sections = test::test_sections();
  for (const char* name : {"close_depth_factor", "strict_distance"}) {
    Parameter parameter = sections[0].parameters[0];
    parameter.name = name;
    sections[0].parameters.push_back(parameter);
  }
  sections.push_back({"mapping", "How the map is made.", {}});
  ConfigurationNode root = parse_yaml(test::good + more, "c.yaml", "/");
  for (const std::string& each : overrides) apply_override(root, each, choice_sections());
  return resolve_configuration(root, "c.yaml", registry, sections);
}

TEST(ConfigurationErrors, RenamedKeysAreUnderstoodWithAWarning) {
  const Configuration configuration = resolve_old_keys(
      "mapping: { close_depth_factor: 30 }\n"
      "filters: [ reprojection_error: { least_matches: 7 }, reprojection_error: { minimum_matches: 8 } ]\n",
      {"tracking.sure_distance=40"});
  const ParameterValues& tracking = configuration.sections.at("tracking");
  EXPECT_EQ(tracking.at("close_depth_factor"), ParameterValue(30.0));
  EXPECT_EQ(tracking.at("strict_distance"), ParameterValue(40.0));
  EXPECT_EQ(configuration.filters[0].values.at("minimum_matches"), ParameterValue(std::int64_t{7}));
  EXPECT_EQ(configuration.filters[1].values.at("minimum_matches"), ParameterValue(std::int64_t{8}));
  std::vector<std::string> warnings;
  for (const Diagnostic& warning : configuration.warnings) warnings.push_back(warning.to_string());
  EXPECT_THAT(warnings,
              ElementsAre("c.yaml:5:12: 'close_depth_factor' of section 'mapping' is now "
                          "'tracking.close_depth_factor'; its value is taken, but rename it",
                          HasSubstr("'sure_distance' of section 'tracking' is now 'tracking.strict_distance'"),
                          StartsWith("c.yaml:6:34: 'least_matches' of filters 'reprojection_error' is now "
                                     "'minimum_matches'")));
}

TEST(ConfigurationErrors, ARenamedKeyBesideItsNewNameIsAnError) {
  try {
    resolve_old_keys("mapping: { close_depth_factor: 30 }\ntracking: { close_depth_factor: 40 }\n");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_STREQ(error.what(),
                 "c.yaml:5:12: 'close_depth_factor' of section 'mapping' is now 'tracking.close_depth_factor', which "
                 "has a value as well; remove one of them");
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
  EXPECT_THAT(
      problems(test::good + "filters:\n  - semantic_mask: { shares: { a: 1, b: 2 } }\n  - semantic_mask: { "
                            "shares: { a: x } }\n"),
      ElementsAre("c.yaml:6:30: found a map for 'shares' of filters 'semantic_mask': 'b': 2 is above 1; expected "
                  "a map from names to numbers, each from 0 to 1",
                  "c.yaml:7:30: found a map for 'shares' of filters 'semantic_mask'; expected a map from names "
                  "to numbers, each from 0 to 1"));
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
