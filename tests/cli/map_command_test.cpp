// SPDX-License-Identifier: BSD-3-Clause
#include "map_command.hpp"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "holdfast/map_io/map_export.hpp"
#include "map_io/map_files.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = -1;
  std::string output, errors;
};

class MapCommand : public test::MapFileTest {
 protected:
  MapCommand() : map_(test::random_map(12, 30, 1)) { write_map(path("map.hfm"), map_); }

  static Outcome run(std::vector<std::string> words) {
    CLI::App app("holdfast");
    Outcome outcome;
    add_map_command(app, outcome.exit_code);
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
    try {
      app.parse(words);
    } catch (const CLI::ParseError& error) {
      outcome.exit_code = app.exit(error, std::cout, std::cerr);
    }
    outcome.output = ::testing::internal::GetCapturedStdout();
    outcome.errors = ::testing::internal::GetCapturedStderr();
    return outcome;
  }
  std::string file() const { return path("map.hfm").string(); }

  Map map_;
};

TEST_F(MapCommand, InfoPrintsATable) {
  const Outcome outcome = run({"map", "info", file()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_THAT(outcome.output, AllOf(StartsWith("file       " + file()), HasSubstr("version 1, made by Holdfast"),
                                    HasSubstr("keyframes  " + std::to_string(map_.keyframes().size())),
                                    HasSubstr("points     " + std::to_string(map_.points().size())),
                                    HasSubstr("loops      2"), HasSubstr("time "), HasSubstr("extent ")));
}

TEST_F(MapCommand, InfoAsJson) {
  const Outcome outcome = run({"map", "info", file(), "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(outcome.output)["points"], map_.points().size());
}

TEST_F(MapCommand, ExportsToFiles) {
  const Outcome outcome = run({"map", "export", file(), "--points", path("points.ply").string(), "--trajectory",
                               path("keyframes.txt").string(), "--json", path("map.json").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, IsEmpty());
  EXPECT_TRUE(content(path("points.ply")) == points_ply(map_));
  EXPECT_EQ(read_trajectory(path("keyframes.txt")).size(), map_.keyframes().size());
  EXPECT_EQ(nlohmann::json::parse(content(path("map.json")))["keyframes"].size(), map_.keyframes().size());
}

TEST_F(MapCommand, ExportsToStandardOutput) {
  const Outcome outcome = run({"map", "export", file(), "--points", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.output == points_ply(map_));
  EXPECT_EQ(run({"map", "export", file(), "--trajectory", "-"}).output, trajectory_text(keyframe_trajectory(map_)));
  const Outcome two = run({"map", "export", file(), "--points", "-", "--json", "-"});
  EXPECT_EQ(two.exit_code, 1);
  EXPECT_THAT(two.errors, HasSubstr("only one export can go to standard output"));
  EXPECT_THAT(two.output, IsEmpty());
}

TEST_F(MapCommand, SaysWhatIsWrong) {
  const Outcome missing = run({"map", "info", path("nothing.hfm").string()});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors,
              AllOf(StartsWith("holdfast map info: "), HasSubstr("nothing.hfm"), HasSubstr("no such file")));
  EXPECT_THAT(missing.output, IsEmpty());
  const std::string bytes = content(path("map.hfm"));
  write("cut.hfm", bytes.substr(0, 1000));
  for (const char* name : {"info", "export"}) {
    std::vector<std::string> words = {"map", name, path("cut.hfm").string()};
    if (std::string(name) == "export") words.insert(words.end(), {"--points", path("points.ply").string()});
    const Outcome cut = run(words);
    EXPECT_EQ(cut.exit_code, 1);
    EXPECT_THAT(cut.errors, HasSubstr("cut off"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("points.ply")));
  const Outcome nothing = run({"map", "export", file()});
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.errors, HasSubstr("--points, --trajectory, --json"));
  const Outcome unwritable = run({"map", "export", file(), "--points", path("nowhere/points.ply").string()});
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_THAT(unwritable.errors, HasSubstr("cannot be written"));
  EXPECT_NE(run({"map"}).exit_code, 0);
  EXPECT_NE(run({"map", "show", file()}).exit_code, 0);
}

TEST_F(MapCommand, HelpHasExamples) {
  EXPECT_THAT(run({"map", "--help"}).output, HasSubstr("holdfast map info out/map.hfm"));
  EXPECT_THAT(run({"map", "info", "--help"}).output, AllOf(HasSubstr("--json"), HasSubstr("Examples")));
  EXPECT_THAT(run({"map", "export", "--help"}).output, AllOf(HasSubstr("--points"), HasSubstr("Examples")));
}

}  // namespace
}  // namespace holdfast
