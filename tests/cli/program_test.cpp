// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest() {
    program_.write("good.yaml",
                   "source: { simulated: { duration: 0.1 } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n");
  }
  test::Program program_;
};

TEST_F(ProgramTest, HelpAndVersion) {
  const Outcome help = program_.run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"run", "bench", "calibrate", "evaluate", "view", "record", "map", "background",
                              "simulate", "segment", "check", "modules"})
    EXPECT_THAT(help.output, HasSubstr(std::string("\n  ") + command + " "));
  EXPECT_EQ(help.errors, "");
  EXPECT_THAT(help.output, AllOf(HasSubstr("man holdfast"), HasSubstr("holdfast manual | man -l -")));
  const Outcome version = program_.run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.output,
              AllOf(StartsWith("holdfast "), HasSubstr("\ncommit     "), HasSubstr("Eigen 3."), HasSubstr("OpenCV 4."),
                    HasSubstr("Ceres "), HasSubstr("yaml-cpp "), HasSubstr("\nSIMD       ")));
  EXPECT_EQ(program_.run({"-V"}).output, version.output);
  const Outcome run = program_.run({"run", "--help"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, AllOf(HasSubstr("--set"), HasSubstr("--output"), HasSubstr("trajectory.txt")));
  EXPECT_EQ(program_.run({"help", "run"}).output, run.output);
  EXPECT_EQ(program_.run({"help", "map", "info"}).output, program_.run({"map", "info", "--help"}).output);
  EXPECT_EQ(program_.run({"help"}).output, help.output);
  EXPECT_EQ(program_.run({"help", "rnu"}).errors, "error: there is no command 'rnu'; did you mean 'run'?\n");
}

TEST_F(ProgramTest, OptionsHaveShortNames) {
  for (const char* command : {"run", "record", "segment", "background", "simulate", "bench"})
    EXPECT_THAT(program_.run({command, "--help"}).output, AllOf(HasSubstr("-o,--output"), HasSubstr("-q,--quiet")))
        << command;
}

TEST_F(ProgramTest, WithoutArgumentsItHelpsAndFails) {
  const Outcome outcome = program_.run({});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("holdfast run"));
  EXPECT_EQ(outcome.output, "");
}

TEST_F(ProgramTest, WrongArguments) {
  const auto expect_error = [&](const std::vector<std::string>& arguments, const std::string& error) {
    const Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << error;
    EXPECT_THAT(outcome.errors, HasSubstr(error));
    EXPECT_EQ(outcome.output, "");
  };
  expect_error({"rnu"}, "error: there is no command 'rnu'; did you mean 'run'?");
  expect_error({"map", "inof", "map.hfm"}, "error: there is no command 'inof'; did you mean 'info'?");
  expect_error({"map", "info"}, "error: FILE is required; see `holdfast map info --help`");
  expect_error({"map", "export", "map.hfm"}, "error: nothing to export; name at least one");
  expect_error({"run", "good.yaml", "--ouput", "out"},
               "error: there is no option '--ouput'; did you mean '--output'? see `holdfast run --help`\n");
  expect_error({"run", "good.yaml", "--output=out", "--overwite", "--quite=1", "-x"},
               "error: there is no option '--overwite'; did you mean '--overwrite'? see `holdfast run --help`\n"
               "error: there is no option '--quite'; did you mean '--quiet'? see `holdfast run --help`\n"
               "error: there is no option '-x'; see `holdfast run --help`\n");
  expect_error({"simulate"}, "error: nothing to write; expected --output FOLDER");
  expect_error({"simulate", "--output", "out", "--duration", "-1"}, "found '-1'; expected a number above 0");
  expect_error({"evaluate-segmentation"}, "error: nothing to compare");
  expect_error({"bench", "nowhere.yaml"}, "error: ");
  expect_error({"run"}, "error: CONFIG is required; see `holdfast run --help`");
  expect_error({"run", "good.yaml"}, "error: --output is required; see `holdfast run --help`");
  expect_error({"check", "good.yaml", "--fast"}, "--fast");
  expect_error({"check", "good.yaml", "--set"}, "--set");
  expect_error({"--vresion"}, "did you mean '--version'? see `holdfast --help`");
}

TEST_F(ProgramTest, ModulesPrintsTheReference) {
  const Outcome all = program_.run({"modules"});
  EXPECT_EQ(all.exit_code, 0);
  for (const char* name : {"orb", "opencv_orb", "ceres", "schur", "tum", "folder", "simulated", "none", "precomputed",
                           "truth", "onnx", "tracking", "mapping", "camera", "run"})
    EXPECT_THAT(all.output, HasSubstr(std::string("\n  ") + name + " "));
  const Outcome orb = program_.run({"modules", "orb"});
  EXPECT_THAT(orb.output, AllOf(HasSubstr("features: orb"), HasSubstr("count"), HasSubstr("Paper: ")));
  const auto json = nlohmann::json::parse(program_.run({"modules", "--json"}).output);
  EXPECT_GE(json.size(), 12U);
  EXPECT_THAT(program_.run({"modules", "--markdown"}).output, HasSubstr("### `simulated`"));
  const Outcome unknown = program_.run({"modules", "obr"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.output, "");
  EXPECT_EQ(unknown.errors, "error: there is no module or section 'obr'; did you mean 'orb'?\n");
}

TEST_F(ProgramTest, CheckAcceptsWhatIsRight) {
  const Outcome good = program_.run({"check", "good.yaml"});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_EQ(good.output, "ok good.yaml: simulated -> orb -> ceres\n");
  const Outcome printed =
      program_.run({"check", "good.yaml", "--set", "features.orb.count=1500", "--set", "run.seed=3", "--print"});
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.output, AllOf(HasSubstr("    count: 1500\n"), HasSubstr("  seed: 3\n")));
  program_.write("printed.yaml", printed.output);
  EXPECT_EQ(program_.run({"check", "printed.yaml", "--print"}).output, printed.output);
}

TEST_F(ProgramTest, TheExamplesAreRight) {
  for (const auto& entry : std::filesystem::directory_iterator(HOLDFAST_EXAMPLE_CONFIGURATIONS)) {
    const Outcome outcome = program_.run({"check", entry.path().string(), "--without-data"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
}

/// A file of the name comes first; a folder cannot be meant.
TEST_F(ProgramTest, InstalledConfigurationsAreNamedWithoutTheirPath) {
  for (const char* name : {"demo", "demo.yaml"}) {
    const Outcome outcome = program_.run({"check", name, "--without-data"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr("configs/demo.yaml: simulated -> orb -> unet"));
  }
  program_.write("demo", program_.text("good.yaml"));
  EXPECT_EQ(program_.run({"check", "demo"}).output, "ok demo: simulated -> orb -> ceres\n");
  std::filesystem::create_directories(program_.path("full"));
  EXPECT_THAT(program_.run({"check", "full", "--without-data"}).output, HasSubstr("configs/full.yaml: tum -> orb"));
  const Outcome unknown = program_.run({"run", "fulll", "--output", "out"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(
      unknown.errors,
      "error: fulll: there is no such file, and no configuration of this name is installed; did you mean 'full'?\n");
  EXPECT_THAT(program_.run({"check", "./demoo"}).errors,
              HasSubstr("./demoo: there is no such file; did you mean 'demo'? expected"));
  EXPECT_THAT(program_.run({"simulate", "emty", "--preview", "empty.png"}).errors, HasSubstr("did you mean 'empty'?"));
}

TEST_F(ProgramTest, CheckWarnsOfAnotherCamera) {
  const Outcome outcome = program_.run({"check", std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/rgbd.yaml", "--set",
                                        "source.tum.path=/data/rgbd_dataset_freiburg3_walking_xyz", "--without-data"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, testing::AllOf(testing::HasSubstr("warning:"), testing::HasSubstr("rgbd.yaml:4:9"),
                                             testing::HasSubstr("expected 'tum_fr3'")));
}

TEST_F(ProgramTest, CheckTellsAllMistakes) {
  program_.write("bad.yaml",
                 "source: { tum: {} }\ncamera: tum_fr7\nfeatures: { orb: { cuont: 500, levels: many } }\noptimizer: "
                 "ceres\nrun: { pace: timestamps }\n");
  const Outcome bad = program_.run({"check", "bad.yaml", "--set", "tracking.nothing=1"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_EQ(bad.output, "");
  for (const char* line :
       {"error: bad.yaml:1:16: source 'tum' needs 'path'", "error: bad.yaml:2:9: there is no known camera 'tum_fr7'",
        "error: bad.yaml:3:20: features 'orb' has no parameter 'cuont'; did you mean 'count'?\n",
        "error: bad.yaml:3:40: found 'many' for 'levels'", "error: bad.yaml:5:14: found 'timestamps'",
        "error: --set tracking.nothing=1: section 'tracking' has no parameter 'nothing'"})
    EXPECT_THAT(bad.errors, HasSubstr(line));
  EXPECT_EQ(std::count(bad.errors.begin(), bad.errors.end(), '\n'), 6);
  // `run` says the same and makes nothing.
  const Outcome run = program_.run({"run", "bad.yaml", "--set", "tracking.nothing=1", "--output", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.errors, bad.errors);
  EXPECT_FALSE(std::filesystem::exists(program_.path("out")));
}

TEST_F(ProgramTest, SetTakesAnyText) {
  // '=', commas, blanks and brackets reach the value whole, and --set takes one argument only.
  const Outcome outcome = program_.run({"check", "--set", "source.tum.path=a=b, c d/[x],y", "--set",
                                        "features.orb.count=77", "good.yaml", "--print", "--without-data"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("/a=b, c d/[x],y\""), HasSubstr("count: 77")));
}

TEST_F(ProgramTest, NamesCannotCommandTheTerminal) {
  const Outcome outcome = program_.run({"check", "\x1b[31mred\x7f\xc2\x9b.yaml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("error: \\x1b[31mred\\x7f\\x9b.yaml: there is no such file"));
  const Outcome compared = program_.run({"evaluate", "\x1b[2J.txt", "b.txt"});
  EXPECT_THAT(compared.errors, HasSubstr("\\x1b[2J.txt: no such file"));
}

TEST_F(ProgramTest, AFullDiskUnderTheOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  for (const std::string arguments : {"modules", "modules --json", "check good.yaml", "check good.yaml --print",
                                      "run good.yaml --output out --overwrite", "--help"}) {
    const std::string command =
        "cd '" + program_.path("").string() + "' && '" HOLDFAST_PROGRAM "' " + arguments + " > /dev/full 2> errors.txt";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1) << arguments;
    // The system's reason is known where nothing was refused before the end.
    EXPECT_THAT(program_.text("errors.txt"),
                AnyOf("error: standard output could not be written; is the disk full?\n",
                      "error: standard output could not be written: No space left on device\n"))
        << arguments;
  }
}

TEST_F(ProgramTest, FilesThatAreNotThere) {
  const Outcome missing = program_.run({"check", "nowhere.yaml"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_EQ(missing.errors, "error: nowhere.yaml: there is no such file; expected a configuration in YAML\n");
  const Outcome recording = program_.run({"run", "good.yaml", "--set", "source.tum.path=nowhere", "--output", "out"});
  EXPECT_EQ(recording.exit_code, 1);
  EXPECT_THAT(recording.errors, AllOf(HasSubstr("/nowhere: is missing"), HasSubstr("source.tum.path")));
  EXPECT_EQ(recording.output, "");
  EXPECT_FALSE(std::filesystem::exists(program_.path("out")));
}

}  // namespace
}  // namespace holdfast
