// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "bench/listed_recording.hpp"
#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// The program's own example of an external system, on a recording of which only the lists are there: nobody looks at
/// the images.
class BenchExternalTest : public ::testing::Test {
 protected:
  BenchExternalTest() { test::write_listed_recording(program_, "recording"); }

  /// One system per name, each the stand-in in that mood.
  static std::string matrix(const std::vector<std::string>& moods) {
    std::string text = "title: Stand-ins\nbaseline: " + moods.front() + "\nsystems:\n";
    for (const std::string& mood : moods)
      text += "  " + mood +
              ":\n    command: [sh, " HOLDFAST_SOURCE_DIR
              "/examples/external/stand_in.sh, '{associations}', '{settings}', '{sequence}', poses.txt]\n"
              "    environment: { STAND_IN: " +
              mood + ", STAND_IN_NAME: 'of {name}' }\n    trajectory: '{output}/poses.txt'\n    time_limit: " +
              (mood == "hang" ? "2" : "60") + "\n";
    return text + "sequences: { little: { source: { tum: { path: recording, frames: 50 } }, camera: tum_fr3 } }\n";
  }

  test::Program program_;
};

TEST_F(BenchExternalTest, ShowsEveryEndAsWhatItIs) {
  program_.write("matrix.yaml", matrix({"good", "half", "crash", "hang", "nan", "empty", "fail"}));
  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "out", "--jobs", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const std::string runs = program_.text("out/tables/runs.csv");
  EXPECT_THAT(runs, AllOf(HasSubstr("\ngood,little,,1,finished,0,50,50,1,0,0,"),
                          HasSubstr("\nhalf,little,,1,finished,0,50,25,0.5,0,0,"),
                          HasSubstr("\ncrash,little,,1,crashed,11,50,25,0.5,0,1,"),
                          HasSubstr("\nhang,little,,1,timed out,0,50,25,0.5,0,0,"),
                          HasSubstr("\nnan,little,,1,finished,0,50,25,0.5,25,0,")));
  EXPECT_THAT(runs, AllOf(HasSubstr("\nempty,little,,1,finished,0,50,0,0,0,0,,,,,,,,,,,,,,,,,,,\n"),
                          HasSubstr("\nfail,little,,1,failed,3,50,0,0,0,0,,,,,,,,,,,,,,,,,,,\n")));
  const std::string report = program_.text("out/report.md");
  EXPECT_THAT(report,
              AllOf(HasSubstr("| crash/little/repeat1 | crashed (signal 11), 1 line is no pose, short | 50.00 %"),
                    HasSubstr("| hang/little/repeat1 | timed out, short | 50.00 %"),
                    HasSubstr("| nan/little/repeat1 | finished, 25 poses are not finite, short | 50.00 %"),
                    HasSubstr("| fail/little/repeat1 | failed (exit code 3), no figures: no trajectory"),
                    HasSubstr("7 of 7 runs done, 3 with a result that counts")));
  // The stand-in moves the truth by a rigid motion, so what counts has no error.
  EXPECT_THAT(program_.text("out/tables/cells.csv"), HasSubstr("\ncrash,little,1,0,0.5,0.5,0.5,,,,"));
  EXPECT_THAT(report, HasSubstr("| little | 0.0000 | 0.0000, 50.00 % |"));

  const std::string folder = "out/runs/good/little/repeat1/";
  EXPECT_THAT(program_.text(folder + "associations.txt"), StartsWith("100.000000 rgb/0.png 100.005000 depth/0.png\n"));
  EXPECT_THAT(program_.text(folder + "settings.yaml"), HasSubstr("Camera.fx: 535.4"));
  EXPECT_THAT(program_.text(folder + "log.txt"), HasSubstr("50 frames of little"));
  EXPECT_TRUE(std::filesystem::exists(program_.path(folder + "tracks.json")));

  // Nothing is run again, and nothing changes.
  const Outcome again = program_.run({"bench", "matrix.yaml", "--output", "out", "--resume"});
  EXPECT_THAT(again.output, HasSubstr("7 of 7 runs were finished before"));
  EXPECT_EQ(program_.text("out/tables/runs.csv"), runs);
  EXPECT_EQ(program_.text("out/report.md"), report);
}

TEST_F(BenchExternalTest, RepeatsOnlyWhatWasAskedOtherwise) {
  program_.write("matrix.yaml", matrix({"good", "half"}));
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "out"}).exit_code, 0);
  EXPECT_EQ(program_.run({"bench", "matrix.yaml", "--output", "out"}).exit_code, 1) << "the folder is not empty";
  std::string changed = matrix({"good", "half", "empty"});
  changed.replace(changed.find("'of {name}'"), 11, "other");
  program_.write("matrix.yaml", changed);
  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "out", "--resume"});
  EXPECT_THAT(outcome.output, HasSubstr("1 of 3 runs were finished before"));
  EXPECT_THAT(outcome.errors,
              AllOf(HasSubstr("good/little"), HasSubstr("empty/little"), Not(HasSubstr("half/little"))));
}

TEST_F(BenchExternalTest, IsStoppedByASignalAndGoesOn) {
  program_.write("matrix.yaml", matrix({"good", "hang"}));
  std::string text = program_.text("matrix.yaml");
  text.replace(text.rfind("time_limit: 2"), 13, "time_limit: 60");
  program_.write("matrix.yaml", text);
  const pid_t process = program_.start({"bench", "matrix.yaml", "--output", "out"});
  while (!std::filesystem::exists(program_.path("out/runs/hang"))) usleep(20'000);
  kill(process, SIGINT);
  const Outcome stopped = program_.finish(process);
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_THAT(stopped.errors,
              HasSubstr("1 of 2 runs are done. Go on with: holdfast bench matrix.yaml --output out --resume"));
  EXPECT_THAT(program_.text("out/report.md"), HasSubstr("**Unfinished**"));
  EXPECT_FALSE(std::filesystem::exists(program_.path("out/runs/hang/little/repeat1")));
}

TEST_F(BenchExternalTest, HasTimedRunsStandAlone) {
  program_.write("matrix.yaml", matrix({"good", "half"}));
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "beside", "--jobs", "2"}).exit_code, 0);
  EXPECT_THAT(program_.text("beside/tables/cost.csv"),
              AllOf(HasSubstr("\ngood,little,1,no,"), HasSubstr("\nhalf,little,1,no,")));
  EXPECT_THAT(program_.text("beside/cost.md"), HasSubstr("**2 runs of 2 had other runs of this bench beside them**"));
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "alone", "--jobs", "2", "--timing"}).exit_code, 0);
  // Whether other programs were busy, too, is not for this test to say.
  for (const char* run : {"good", "half"})
    EXPECT_THAT(
        program_.text(std::string("alone/runs/") + run + "/little/repeat1/cost.json"),
        AllOf(HasSubstr("\"alone\": true"), HasSubstr("\"other_processors\": "), HasSubstr("\"load_average\": ")));
  EXPECT_THAT(program_.text("alone/cost.md"), Not(HasSubstr("other runs of this bench beside them")));
  EXPECT_EQ(program_.text("alone/report.md"), program_.text("beside/report.md"));
}

TEST_F(BenchExternalTest, TheDoctorSaysWhatIsFoundAndWhatIsMissing) {
  for (const char* folder : {"orb/Examples/RGB-D", "orb/lib"})
    std::filesystem::create_directories(program_.path(folder));
  program_.write("orb/Examples/RGB-D/rgbd_tum", "");
  program_.write("orb/lib/libORB_SLAM2.so", "");
  const Outcome outcome = program_.run({"bench", "doctor", "--data", "ORB_SLAM2=" + program_.path("orb").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(
      outcome.output,
      AllOf(HasSubstr("orb_slam2: not ready"), HasSubstr("found    Examples/RGB-D/rgbd_tum"),
            HasSubstr("missing  Vocabulary/ORBvoc.txt"),
            HasSubstr("missing  the variable ORB_SLAM3, the folder of its build: set it in the environment"),
            HasSubstr("stella_vslam: not ready"), HasSubstr("get it from https://github.com/raulmur/ORB_SLAM2")));
}

/// A stand-in in place of a program of others, called through its wrapper.
TEST_F(BenchExternalTest, AWrapperCallsASystemByItsName) {
  std::filesystem::create_directories(program_.path("stella"));
  program_.write("stella/orb_vocab.fbow", "");
  program_.write(
      "stella/run_tum_rgbd_slam",
      "#!/bin/sh\n[ \"$1 $3\" = '-v -d' ] || exit 9\n"
      "exec sh " HOLDFAST_SOURCE_DIR
      "/examples/external/stand_in.sh \"${6%stella.yaml}associations.txt\" \"${6%stella.yaml}settings.yaml\" \"$4\" "
      "\"${6%stella.yaml}frame_trajectory.txt\"\n");
  std::filesystem::permissions(program_.path("stella/run_tum_rgbd_slam"), std::filesystem::perms::owner_all);
  program_.write("matrix.yaml",
                 "systems: { theirs: { wrapper: stella_vslam, repeats: 1, environment: { STAND_IN: good } } }\n"
                 "sequences: { little: { source: { tum: { path: recording, frames: 50 } }, camera: tum_fr3 } }\n");
  const Outcome outcome = program_.run(
      {"bench", "matrix.yaml", "--output", "out", "--data", "STELLA_VSLAM=" + program_.path("stella").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(program_.text("out/tables/runs.csv"), HasSubstr("\ntheirs,little,,1,finished,0,50,50,1,"))
      << program_.text("out/runs/theirs/little/repeat1/log.txt");
  EXPECT_THAT(program_.text("out/runs/theirs/little/repeat1/stella.yaml"),
              AllOf(HasSubstr("  setup: RGBD\n"), HasSubstr("  fx: 535.4\n"), HasSubstr("  cols: 640\n"),
                    HasSubstr("  depthmap_factor: 5000.0\n")));
  program_.write("matrix.yaml", "systems: { theirs: { wrapper: stella_slam } }\nsequences: {}\n");
  EXPECT_THAT(program_.run({"bench", "matrix.yaml", "--dry-run"}).errors,
              HasSubstr("matrix.yaml:1:31: there is no wrapper 'stella_slam'; did you mean 'stella_vslam'"));
}

TEST_F(BenchExternalTest, SaysWhatIsWrongWithExecutors) {
  program_.write("matrix.yaml", "executor: { slurm: { processors: few, colour: red } }\n" + matrix({"good"}));
  const auto errors = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"bench", "matrix.yaml", "--output", "out"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = program_.run(words);
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.errors;
  };
  EXPECT_THAT(errors({"--slurm", "poll_seconds=0"}),
              AllOf(HasSubstr("matrix.yaml:1:34: found 'few' for 'processors' of slurm; expected a whole number"),
                    HasSubstr("matrix.yaml:1:47: slurm has no option 'colour'; "),
                    HasSubstr("--slurm poll_seconds=0: found '0' for 'poll_seconds'")));
  program_.write("matrix.yaml", matrix({"good"}));
  EXPECT_THAT(errors({"--attach"}), HasSubstr("the executor is local, whose runs end with it"));
  EXPECT_THAT(errors({"--run", "good/little/repeat9"}), HasSubstr("the matrix has no run 'good/little/repeat9'"));
  EXPECT_THAT(errors({"--table", "paper4"}), HasSubstr("paper4"));
  program_.write("matrix.yaml", "executor: cloud\n" + matrix({"good"}));
  EXPECT_THAT(errors({}), HasSubstr("matrix.yaml:1:11: found 'cloud' for 'executor'"));
}

/// What an executor calls on another machine: one run, no report, and nothing the second time.
TEST_F(BenchExternalTest, OneRunAloneIsWhatAnExecutorAsksFor) {
  program_.write("matrix.yaml", matrix({"good", "half"}));
  const std::vector<std::string> words = {"bench", "matrix.yaml", "--output", "out", "--run", "half/little/repeat1"};
  ASSERT_EQ(program_.run(words).exit_code, 0);
  const std::string result = program_.path("out/runs/half/little/repeat1/result.json").string();
  ASSERT_TRUE(std::filesystem::exists(result));
  EXPECT_FALSE(std::filesystem::exists(program_.path("out/runs/good")));
  EXPECT_FALSE(std::filesystem::exists(program_.path("out/report.md")));
  const auto time = std::filesystem::last_write_time(result);
  ASSERT_EQ(program_.run(words).exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(result), time);
}

/// The example for GNU parallel, with this host alone.
TEST_F(BenchExternalTest, RunsGoThroughGnuParallel) {
  if (std::system("parallel --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "GNU parallel (Debian: parallel) is missing";
  program_.write("matrix.yaml", matrix({"good", "half"}));
  const std::string command = "cd '" + program_.path("").string() +
                              "' && HOLDFAST='" HOLDFAST_PROGRAM "' sh '" HOLDFAST_SOURCE_DIR
                              "/examples/external/bench_over_ssh.sh' 2/: matrix.yaml out > log.txt 2>&1 < /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0) << program_.text("log.txt");
  EXPECT_THAT(program_.text("log.txt"), HasSubstr("2 of 2 runs were finished before"));
  EXPECT_THAT(program_.text("out/tables/runs.csv"),
              AllOf(HasSubstr("\ngood,little,,1,finished,0,50,50,"), HasSubstr("\nhalf,little,,1,finished,0,50,25,")));
}

TEST_F(BenchExternalTest, FindsTheMatricesOfTheProjectSound) {
  // `composed` has two of the five again, with masks by the U-Net.
  for (const auto& [name, variants] : {std::pair{"bonn", 5}, {"composed", 7}, {"simulated", 5}, {"tum_dynamic", 5}}) {
    const Outcome list =
        program_.run({"bench", HOLDFAST_SOURCE_DIR "/benchmarks/" + std::string(name) + ".yaml", "--dry-run"});
    EXPECT_EQ(list.exit_code, 0) << name << "\n" << list.errors;
    EXPECT_THAT(list.output, HasSubstr(" runs: " + std::to_string(variants) + " variants")) << name;
  }
}

TEST_F(BenchExternalTest, ListsRunsAndWhatIsMissing) {
  program_.write("matrix.yaml",
                 "systems: { theirs: { command: [/no/such/program] } }\n"
                 "sequences: { gone: { source: { tum: { path: '${HOLDFAST_NOWHERE}/gone' } }, camera: tum_fr3,\n"
                 "                     about: ask Ada } }\n");
  const Outcome list = program_.run({"bench", "matrix.yaml", "--dry-run"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.output, AllOf(HasSubstr("theirs/gone/repeat1\n1 run:"), HasSubstr("'/no/such/program' is missing"),
                                 HasSubstr("the variable 'HOLDFAST_NOWHERE' is not set"), HasSubstr("ask Ada")));
  const Outcome run = program_.run({"bench", "matrix.yaml", "--output", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, AllOf(HasSubstr("matrix.yaml:1:12: system 'theirs'"), HasSubstr("matrix.yaml:2:14")));
  EXPECT_FALSE(std::filesystem::exists(program_.path("out")));
}

}  // namespace
}  // namespace holdfast
