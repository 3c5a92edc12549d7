// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "fixture.hpp"
#include "holdfast/config/missing_file.hpp"

namespace holdfast {
namespace {

using test::problems;
using testing::ElementsAre;
using testing::StartsWith;

TEST(Yaml, KnowsThePlaceOfEveryKeyAndValue) {
  const ConfigurationNode root = parse_yaml("a: 1\n\nlist:\n  - x\n  - { k: 'v' }\n", "f.yaml", "/data");
  EXPECT_EQ(root.entries[0].location.to_string(), "f.yaml:1:1");
  EXPECT_EQ(root.entries[0].value.location.to_string(), "f.yaml:1:4");
  const ConfigurationNode& list = *root.find("list");
  EXPECT_EQ(list.items[0].location.to_string(), "f.yaml:4:5");
  EXPECT_EQ(list.items[1].entries[0].location.to_string(), "f.yaml:5:7");
  EXPECT_EQ(list.items[1].find("k")->location.to_string(), "f.yaml:5:10");
  EXPECT_TRUE(list.items[1].find("k")->quoted);
  EXPECT_FALSE(list.items[0].quoted);
}

TEST(Yaml, ReportsASyntaxErrorAlone) {
  EXPECT_THAT(problems("bogus: 1\nbogus: 2\nsource: [ tum\n"), ElementsAre(StartsWith("c.yaml:4:1: syntax error: ")));
}

TEST(Yaml, ReportsDuplicateKeysAllTogether) {
  EXPECT_THAT(problems("run: { seed: 1, seed: 2 }\ncamera: bonn\nrun: {}\n"),
              ElementsAre("c.yaml:1:17: duplicate key 'seed'; it stands already in line 1; keep one of them",
                          "c.yaml:3:1: duplicate key 'run'; it stands already in line 1; keep one of them"));
}

TEST(Yaml, FindsADuplicateAmongVeryManyKeys) {
  std::string text;
  for (int i = 0; i < 60000; ++i) text += "k" + std::to_string(i) + ": 1\n";
  EXPECT_THAT(problems(text + "k7: 2\n"),
              ElementsAre("c.yaml:60001:1: duplicate key 'k7'; it stands already in line 8; keep one of them"));
}

TEST(Yaml, RefusesMergeKeysAndOddKeys) {
  EXPECT_THAT(problems("a: &x { b: 1 }\nc:\n  <<: *x\n[d]: 1\n"),
              ElementsAre(StartsWith("c.yaml:3:3: merge keys (<<) are not supported"),
                          StartsWith("c.yaml:4:1: found a key that is no plain text")));
}

TEST(Yaml, FollowsAliases) {
  const ConfigurationNode root = parse_yaml("a: &x { b: 7 }\nc: *x\n", "f.yaml", "/data");
  EXPECT_EQ(root.find("c")->find("b")->text, "7");
}

TEST(Yaml, RefusesAliasesThatNeverEnd) {
  EXPECT_THAT(problems("a: &x [ *x ]\n"), ElementsAre(StartsWith("c.yaml:1:")));
  EXPECT_THAT(problems("a: &x { b: { c: *x } }\n"), ElementsAre(StartsWith("c.yaml:1:")));
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 7; ++k) text += ", " + before;
    text += "]\n";
  }
  EXPECT_THAT(problems(text), ElementsAre(testing::HasSubstr("aliases")));
}

TEST(Yaml, RefusesASecondDocument) {
  EXPECT_THAT(problems(test::good + "---\nrun: { seed: 5 }\n"), ElementsAre(StartsWith("c.yaml:5:1: found a second")));
  EXPECT_TRUE(problems("---\n" + test::good).empty());
}

TEST(Yaml, RefusesTextThatBelongsToNothing) {
  EXPECT_THAT(problems(","), ElementsAre(StartsWith("c.yaml:1:1: syntax error: found text that continues no")));
  EXPECT_THAT(problems(",\n---\n"), ElementsAre(StartsWith("c.yaml:1:1: syntax error: ")));
  EXPECT_THAT(problems("run: [a], b\n"), ElementsAre(StartsWith("c.yaml:1:9: syntax error: ")));
  EXPECT_THAT(problems("[a]\n, b\n"), ElementsAre(StartsWith("c.yaml:2:1: syntax error: ")));
  EXPECT_THAT(problems(test::good, {"source.tum.path=,x"}),
              ElementsAre(StartsWith("--set source.tum.path=,x:1:1: syntax error: ")));
}

TEST(Yaml, RefusesWhatIsNoMap) {
  EXPECT_THAT(problems("- a\n"), ElementsAre(testing::HasSubstr("found a list; expected a map with the sections")));
  EXPECT_THAT(problems(""), ElementsAre(testing::HasSubstr("found nothing; expected a map with the sections")));
}

TEST(Yaml, NamesAFileThatCannotBeRead) {
  EXPECT_THROW(read_yaml("/nowhere/c.yaml"), ConfigurationError);
  EXPECT_THROW(read_yaml("/"), ConfigurationError);
  EXPECT_THROW(read_yaml(std::string(300, 'a') + ".yaml"), ConfigurationError);
}

TEST(Yaml, AMissingFileIsAnsweredWithTheNearestOfItsFolder) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "holdfast_missing_file_test";
  std::filesystem::create_directories(folder);
  for (const char* name : {"crowd.yaml", "crowds.yaml", "walking.txt"}) std::ofstream(folder / name) << "a: 1\n";
  EXPECT_EQ(missing_file_text(folder / "crwod.yaml", "scene file"),
            "there is no such scene file; did you mean 'crowd.yaml'?");
  EXPECT_EQ(missing_file_text(folder / "walking.yaml", "file"), "there is no such file;");
  EXPECT_EQ(missing_file_text(folder / "below/crowd.yaml", "file"),
            "there is no such file; its folder is missing too;");
  try {
    read_yaml(folder / "crwod.yaml");
    ADD_FAILURE() << "a file that is not there was read";
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.diagnostics().front().message,
              "there is no such file; did you mean 'crowd.yaml'? expected a configuration in YAML");
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace holdfast
