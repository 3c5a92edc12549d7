// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/fake_registry.hpp"

namespace holdfast {
namespace {

using test::complaints;
using test::rest;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// The complaints about one `features` section of module orb, which stands in line 3.
std::string orb(const std::string& parameters) { return complaints(rest + "features: { orb: " + parameters + " }\n"); }

TEST(ConfigurationErrors, ThereAreNoneInTheCommonConfiguration) {
  EXPECT_EQ(complaints(rest + "features: orb\n"), "");
  EXPECT_EQ(orb("{}"), "");
}

TEST(ConfigurationErrors, UnknownSection) {
  EXPECT_EQ(complaints(rest + "features: orb\n  \nfilter: []\n"),
            "c.yaml:5:1: there is no section 'filter'; did you mean 'filters'?\n");
  EXPECT_THAT(complaints(rest + "features: orb\nzzzzzzzzzz: 1\n"),
              AllOf(StartsWith("c.yaml:4:1: there is no section 'zzzzzzzzzz'; known are "), HasSubstr("tracking")));
}

TEST(ConfigurationErrors, UnknownModule) {
  EXPECT_EQ(complaints(rest + "features: { obr: { count: 3 } }\n"),
            "c.yaml:3:13: there is no features module 'obr'; did you mean 'orb'?\n");
  EXPECT_EQ(complaints(rest + "features: obr\n"),
            "c.yaml:3:11: there is no features module 'obr'; did you mean 'orb'?\n");
  EXPECT_EQ(complaints(rest + "features: superpoint\n"),
            "c.yaml:3:11: there is no features module 'superpoint'; known are opencv_orb, orb\n");
  EXPECT_EQ(complaints(rest + "features: orb\nfilters:\n  - semantic_mask\n  - reprojection_eror: {}\n"),
            "c.yaml:6:5: there is no filters module 'reprojection_eror'; did you mean 'reprojection_error'?\n");
}

TEST(ConfigurationErrors, UnknownParameter) {
  EXPECT_EQ(orb("{ cuont: 500 }"), "c.yaml:3:20: features 'orb' has no parameter 'cuont'; did you mean 'count'?\n");
  EXPECT_EQ(complaints(rest + "features: orb\ntracking: { treshold: 1 }\n"),
            "c.yaml:4:13: section 'tracking' has no parameter 'treshold'; did you mean 'threshold'?\n");
  EXPECT_EQ(complaints(rest + "features: opencv_orb\nfilters: [ semantic_mask: { dilate: 5 } ]\n"),
            "c.yaml:4:29: filters 'semantic_mask' has no parameter 'dilate'; none is known\n");
}

TEST(ConfigurationErrors, WrongTypes) {
  struct Case {
    std::string parameters;
    int column;
    std::string found, expected;
  };
  const std::vector<Case> cases = {
      {"{ flag: 1 }", 26, "found '1' for 'flag'", "expected true or false"},
      {"{ flag: yes }", 26, "found 'yes' for 'flag'", "expected true or false"},
      {"{ flag: \"true\" }", 26, "found 'true' for 'flag'", "expected true or false"},
      {"{ count: 500.5 }", 27, "found '500.5' for 'count'", "expected an integer from 50 to 20000"},
      {"{ count: 1e3 }", 27, "found '1e3' for 'count'", "expected an integer"},
      {"{ count: \"500\" }", 27, "found '500' for 'count'", "expected an integer"},
      {"{ count: 500px }", 27, "found '500px' for 'count'", "expected an integer"},
      {"{ count: +-500 }", 27, "found '+-500' for 'count'", "expected an integer"},
      {"{ count: 99999999999999999999 }", 27, "found '99999999999999999999' for 'count'", "expected an integer"},
      {"{ count: [500] }", 27, "found a list for 'count'", "expected an integer"},
      {"{ count: { a: 1 } }", 27, "found a map for 'count'", "expected an integer"},
      {"{ scale: big }", 27, "found 'big' for 'scale'", "expected a number from 1.01 to 4 [m]"},
      {"{ scale: .nan }", 27, "found '.nan' for 'scale'", "expected a number"},
      {"{ scale: inf }", 27, "found 'inf' for 'scale'", "expected a number"},
      {"{ text: [a] }", 26, "found a list for 'text'", "expected a text"},
      {"{ file: { a: b } }", 26, "found a map for 'file'", "expected a path"},
      {"{ words: a }", 27, "found 'a' for 'words'", "expected a list of texts"},
      {"{ words: [a, [b]] }", 27, "found a list for 'words'", "expected a list of texts"},
      {"{ numbers: 3 }", 29, "found '3' for 'numbers'", "expected a list of numbers"},
      {"{ numbers: [3, x] }", 29, "found a list for 'numbers'", "expected a list of numbers"},
      {"{ pairs: [a] }", 27, "found a list for 'pairs'", "expected"},
      {"{ pairs: { a: [b] } }", 27, "found a map for 'pairs'", "expected"},
  };
  for (const Case& wrong : cases) {
    const std::string text = orb(wrong.parameters);
    EXPECT_THAT(
        text, AllOf(StartsWith("c.yaml:3:" + std::to_string(wrong.column) + ": " + wrong.found + " of features 'orb'"),
                    HasSubstr(wrong.expected)))
        << wrong.parameters;
    EXPECT_EQ(lines(text), 1U) << wrong.parameters;
  }
}

TEST(ConfigurationErrors, AParameterWithoutAValue) {
  EXPECT_THAT(
      complaints(rest + "features:\n  orb:\n    count:\n    text: a\n"),
      AllOf(StartsWith("c.yaml:5:5: "), HasSubstr("found nothing for 'count' of features 'orb'; expected an integer")));
}

TEST(ConfigurationErrors, OutOfRange) {
  EXPECT_THAT(orb("{ count: 49 }"),
              AllOf(StartsWith("c.yaml:3:27: found '49' for 'count' of features 'orb': 49 is below 50"),
                    HasSubstr("from 50 to 20000")));
  EXPECT_THAT(orb("{ count: 20001 }"), HasSubstr("20001 is above 20000"));
  EXPECT_THAT(orb("{ scale: 4.5 }"), HasSubstr("4.5 is above 4"));
  EXPECT_THAT(orb("{ big: -1 }"), HasSubstr("-1"));
  EXPECT_THAT(orb("{ numbers: [1, -2] }"), HasSubstr("-2 is below 0"));
  EXPECT_THAT(orb("{ colour: gren }"), AllOf(HasSubstr("found 'gren' for 'colour'"), HasSubstr("green")));
  EXPECT_EQ(orb("{ count: 50 }") + orb("{ count: 20000 }") + orb("{ scale: 4 }") + orb("{ numbers: [0, 1e9] }"), "");
}

TEST(ConfigurationErrors, MissingSectionsAndParameters) {
  const std::string all = complaints("run: { seed: 3 }\n");
  EXPECT_EQ(lines(all), 3U);
  EXPECT_THAT(all, HasSubstr("c.yaml: section 'source' is missing; expected one module; known are still, tum\n"));
  EXPECT_THAT(all,
              HasSubstr("c.yaml: section 'features' is missing; expected one module; known are opencv_orb, orb\n"));
  EXPECT_THAT(all, HasSubstr("c.yaml: section 'optimizer' is missing; expected one module; known are ceres\n"));
  EXPECT_THAT(complaints("source:\noptimizer: ceres\nfeatures: orb\n"),
              AllOf(StartsWith("c.yaml:1:1: "), HasSubstr("section 'source' is empty")));
  EXPECT_EQ(complaints("source: tum\noptimizer: ceres\nfeatures: orb\n"),
            "c.yaml:1:9: source 'tum' needs 'path' (folder of the recording); expected a path\n");
  EXPECT_EQ(complaints("source: { tum: }\noptimizer: ceres\nfeatures: orb\n"),
            "c.yaml:1:11: source 'tum' needs 'path' (folder of the recording); expected a path\n");
}

TEST(ConfigurationErrors, AChoiceIsOneModule) {
  EXPECT_EQ(complaints(rest + "features: { orb: {}, opencv_orb: {} }\n"),
            "c.yaml:3:11: found 2 keys (orb, opencv_orb) for 'features'; expected one module, as `name` or { name: { "
            "... } }; "
            "known are opencv_orb, orb\n");
  EXPECT_THAT(complaints(rest + "features: {}\n"), HasSubstr("found 0 keys for 'features'; expected one module"));
  EXPECT_THAT(complaints(rest + "features: [orb]\n"),
              StartsWith("c.yaml:3:11: found a list for 'features'; expected one module"));
  EXPECT_THAT(complaints(rest + "features: { orb: 1000 }\n"),
              StartsWith("c.yaml:3:18: found '1000'; expected the parameters of features 'orb' as a map"));
}

TEST(ConfigurationErrors, AChainIsAList) {
  EXPECT_THAT(complaints(rest + "features: orb\nfilters: semantic_mask\n"),
              StartsWith("c.yaml:4:10: found 'semantic_mask' for 'filters'; expected a list"));
  EXPECT_THAT(complaints(rest + "features: orb\nfilters: { semantic_mask: {} }\n"),
              StartsWith("c.yaml:4:10: found a map for 'filters'; expected a list"));
  EXPECT_THAT(complaints(rest + "features: orb\nobservers: [ [dump] ]\n"),
              StartsWith("c.yaml:4:14: found a list for 'observers'"));
}

TEST(ConfigurationErrors, SectionsAreMaps) {
  EXPECT_THAT(complaints(rest + "features: orb\ntracking: 3\n"),
              StartsWith("c.yaml:4:11: found '3'; expected the parameters of section 'tracking' as a map"));
  EXPECT_THAT(complaints(rest + "features: orb\nrun: [1]\n"), StartsWith("c.yaml:4:6: found a list"));
}

TEST(ConfigurationErrors, ASyntaxErrorStandsAlone) {
  const std::string text = complaints("source: { tum: { path: /data }\nfeatures: obr\nnonsense: [\n");
  EXPECT_THAT(text, AllOf(StartsWith("c.yaml:2:"), HasSubstr("syntax error: ")));
  EXPECT_EQ(lines(text), 1U);
  EXPECT_THAT(complaints("source: tum\n\toptimizer: ceres\n"), StartsWith("c.yaml:2:1: syntax error"));
  EXPECT_THAT(complaints("features: *orb\n"), AllOf(StartsWith("c.yaml:1:11: syntax error"), HasSubstr("anchor")));
}

TEST(ConfigurationErrors, KeysThatYamlWouldLetPass) {
  EXPECT_EQ(complaints(rest + "features: orb\nsource: still\n"),
            "c.yaml:4:1: duplicate key 'source'; it stands already in line 1; keep one of them\n");
  EXPECT_THAT(complaints(rest + "features:\n  orb:\n    count: 60\n    count: 70\n"),
              StartsWith("c.yaml:6:5: duplicate key 'count'; it stands already in line 5"));
  EXPECT_THAT(complaints("base: &base { a: b }\nfeatures: { orb: { <<: *base } }\n"),
              AllOf(StartsWith("c.yaml:2:20: merge keys (<<)"), HasSubstr("alias")));
  EXPECT_THAT(complaints("? [a, b]\n: c\n"), HasSubstr("c.yaml:1:3: found a key that is no plain text"));
  // All of them together.
  EXPECT_EQ(lines(complaints("a: 1\na: 2\nb: { <<: 3 }\n? [x]\n: 4\n")), 3U);
}

TEST(ConfigurationErrors, AliasesInsideOfWhatTheyName) {
  EXPECT_THAT(complaints("features: &f { orb: *f }\n"), HasSubstr("nested too deeply"));
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) bomb += (k == 0 ? "" : ", ") + last;
    bomb += "]\n";
  }
  EXPECT_THAT(complaints(bomb), HasSubstr("repeated too often"));
}

TEST(ConfigurationErrors, FilesThatAreNoConfiguration) {
  EXPECT_EQ(complaints(""),
            "c.yaml: found nothing; expected a map with the sections source, features, optimizer, ...\n");
  EXPECT_THAT(complaints("# only a comment\n"), HasSubstr("found nothing; expected a map"));
  EXPECT_THAT(complaints("just a text\n"), HasSubstr("found 'just a text'; expected a map"));
  EXPECT_THAT(complaints("- source\n"), HasSubstr("found a list; expected a map"));
  EXPECT_THAT(complaints("a: 1\n---\nb: 2\n"), HasSubstr("found 2 documents"));
  Registry registry = test::fake_registry();
  const auto message = [&](const std::string& file) -> std::string {
    try {
      load_configuration(file, {}, registry, {});
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("/nowhere/c.yaml"), "/nowhere/c.yaml: there is no such file; expected a configuration in YAML");
  EXPECT_EQ(message("/tmp"), "/tmp: is a folder; expected a configuration in YAML");
}

TEST(ConfigurationErrors, Plugins) {
  EXPECT_THAT(complaints(rest + "features: orb\nplugins: [ libnowhere.so ]\n"),
              AllOf(StartsWith("c.yaml:4:12: plugin 'libnowhere.so' cannot be found; searched: "),
                    HasSubstr("HOLDFAST_PLUGIN_PATH")));
  EXPECT_THAT(complaints(rest + "features: orb\nplugins: [ ./sub/../x.so ]\n"),
              AllOf(StartsWith("c.yaml:4:12: plugin '/"), HasSubstr("/x.so' cannot be loaded: there is no such file")));
  EXPECT_THAT(complaints(rest + "features: orb\nplugins: x.so\n"),
              StartsWith("c.yaml:4:10: found 'x.so' for 'plugins'; expected a list of files"));
  EXPECT_THAT(complaints(rest + "features: orb\nplugins: [[x]]\n"),
              StartsWith("c.yaml:4:11: found a list; expected the file of a plugin"));
}

TEST(ConfigurationErrors, Cameras) {
  EXPECT_THAT(complaints(rest + "features: orb\ncamera: tum_fr9\n"),
              AllOf(StartsWith("c.yaml:4:9: there is no known camera 'tum_fr9'"),
                    HasSubstr("or numbers as { width: 640"), HasSubstr("did you mean 'tum_fr")));
  const std::string text =
      complaints(rest + "features: orb\ncamera: { width: 640, height: 480, fx: 500, fy: 500, cx: 320, c: 240 }\n");
  EXPECT_EQ(lines(text), 2U);
  EXPECT_THAT(text, HasSubstr("c.yaml:4:63: section 'camera' has no parameter 'c'"));
  EXPECT_THAT(text, HasSubstr("c.yaml:4:9: section 'camera' needs 'cy'"));
}

TEST(ConfigurationErrors, OneModeOnly) {
  EXPECT_EQ(complaints(rest + "features: orb\nrun: { mode: threaded }\n"),
            "c.yaml:4:14: found 'threaded' for 'mode' of section 'run'; this version runs in sequential mode only\n");
  EXPECT_THAT(complaints(rest + "features: orb\nrun: { mode: paralel }\n"), HasSubstr("sequential"));
}

TEST(ConfigurationErrors, AllAtOnceDownTheFile) {
  const std::string text = complaints(R"(run: { sed: 1 }
features:
  orb:
    count: many
    scal: 2
nonsense: 1
filters:
  - nobody
tracking: { threshold: -1 }
)",
                                      {"run.speed=3"});
  std::vector<std::string> starts;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) starts.push_back(line.substr(0, line.find(": ")));
  EXPECT_EQ(starts, (std::vector<std::string>{"c.yaml:1:8", "c.yaml:4:12", "c.yaml:5:5", "c.yaml:6:1", "c.yaml:8:5",
                                              "c.yaml:9:24", "c.yaml", "c.yaml", "--set run.speed=3"}))
      << text;
}

}  // namespace
}  // namespace holdfast
