// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
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
      "[ \"$(sed -n 4p $4/rgb.txt)\" = '100.000000 recording/rgb/0.png' ] || exit 8\n"
      "[ \"$(sed -n 53p $4/depth.txt)\" = '104.900000 recording/depth/49.png' ] || exit 7\n"
      "exec sh " HOLDFAST_SOURCE_DIR
      "/examples/external/stand_in.sh \"${6%stella.yaml}associations.txt\" \"${6%stella.yaml}settings.yaml\" "
      "\"$4/recording\" "
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
                    HasSubstr("  depthmap_factor: 5000.0\n"), HasSubstr("  baseline_dist_thr: 0.08\n")));
  program_.write("matrix.yaml", "systems: { theirs: { wrapper: stella_slam } }\nsequences: {}\n");
  EXPECT_THAT(program_.run({"bench", "matrix.yaml", "--dry-run"}).errors,
              HasSubstr("matrix.yaml:1:31: there is no wrapper 'stella_slam'; did you mean 'stella_vslam'"));
}

/// Both run where they find their own files, and DynaSLAM gets masks by the names of the colour images.
TEST_F(BenchExternalTest, WrappersGiveSystemsWhatTheyLookForBesideThem) {
  const auto make_build = [&](const std::string& folder, const std::string& check) {
    std::filesystem::create_directories(program_.path(folder + "/Examples/RGB-D"));
    const std::string program = folder + "/Examples/RGB-D/rgbd_tum";
    program_.write(program, "#!/bin/sh\n" + check +
                                "\nexec sh " HOLDFAST_SOURCE_DIR
                                "/examples/external/stand_in.sh \"$4\" \"$2\" \"$3\" CameraTrajectory.txt\n");
    std::filesystem::permissions(program_.path(program), std::filesystem::perms::owner_all);
  };
  make_build("ngd", "[ $# = 4 ] && [ -e ./Thirdparty/YOLO/coco.names ] || exit 9");
  std::filesystem::create_directories(program_.path("ngd/Thirdparty/YOLO"));
  program_.write("ngd/Thirdparty/YOLO/coco.names", "");
  make_build("dyna",
             "[ $# = 5 ] && [ -e ./Examples/RGB-D ] && [ -e ./src/python ] || exit 9\n"
             "[ \"$(cat \"$5/7.png\")\" = seven ] && [ ! -e \"$5/8.png\" ] || exit 8");
  std::filesystem::create_directories(program_.path("dyna/src/python"));
  std::filesystem::create_directories(program_.path("recording/mask"));
  program_.write("recording/mask/7.png", "seven");
  // In place of a display.
  std::filesystem::create_directories(program_.path("bin"));
  program_.write("bin/xvfb-run", "#!/bin/sh\nshift\nexec \"$@\"\n");
  std::filesystem::permissions(program_.path("bin/xvfb-run"), std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (program_.path("bin").string() + ":" + path).c_str(), 1);
  program_.write("matrix.yaml",
                 "systems: { ngd: { wrapper: ngd_slam, repeats: 1 }, dyna: { wrapper: dynaslam, repeats: 1 } }\n"
                 "sequences: { little: { source: { tum: { path: recording, frames: 50 } }, camera: tum_fr3 } }\n");
  const Outcome outcome =
      program_.run({"bench", "matrix.yaml", "--output", "out", "--data", "NGD_SLAM=" + program_.path("ngd").string(),
                    "--data", "DYNASLAM=" + program_.path("dyna").string()});
  setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(program_.text("out/tables/runs.csv"), AllOf(HasSubstr("\nngd,little,,1,finished,0,50,50,1,"),
                                                          HasSubstr("\ndyna,little,,1,finished,0,50,50,1,")))
      << program_.text("out/runs/dyna/little/repeat1/log.txt");
}

/// Frames that no recording holds: of another source, and perturbed. The stand-in has a pose for every frame it gets.
TEST_F(BenchExternalTest, SystemsGetCopiesOfPerturbedFramesAndOfOtherSources) {
  std::string text =
      "axes: { perturbation: { dropped: [0.5], calibration: [0.1] } }\nbaseline: { perturbation: none }\n"
      "base: plain.yaml\n" +
      matrix({"good"});
  text.erase(text.find("baseline: good\n"), 15);
  text.replace(text.find("sequences: "), std::string::npos,
               "exclude: [{ system: good, perturbation: calibration-0.1, sequence: second }]\n"
               "sequences:\n  room: { source: { simulated: { path: xyz, duration: 1 } }, camera: &small { width: 160, "
               "height: 120, fx: 140, fy: 140, cx: 80, cy: 60 } }\n"
               "  second: { source: { simulated: { path: rpy, duration: 0.5 } }, camera: *small }\n");
  program_.write("plain.yaml", "features: { orb: { count: 100 } }\noptimizer: schur\n");
  program_.write("matrix.yaml", text);
  const std::vector<std::string> words = {"bench", "matrix.yaml", "--output", "out", "--keep-copies"};
  const Outcome outcome = program_.run(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_FALSE(std::filesystem::exists(program_.path("out/runs/good+calibration-0.1/second")));
  const auto frames = [&](const std::string& copy) {
    const std::string list = program_.text("out/copies/" + copy + "/associations.txt");
    return std::count(list.begin(), list.end(), '\n');
  };
  EXPECT_EQ(frames("room/none"), 30);
  const auto kept = frames("room/dropped-0.5");
  EXPECT_TRUE(kept > 5 && kept < 25) << kept;
  const std::string runs = program_.text("out/tables/runs.csv"), count = std::to_string(kept);
  EXPECT_THAT(runs, AllOf(HasSubstr("\ngood,room,,1,finished,0,30,30,1,"),
                          HasSubstr("\ngood+dropped-0.5,room,,1,finished,0," + count + "," + count + ",1,")));
  const auto focal_length = [&](const std::string& variant) {
    const std::string settings = program_.text("out/runs/" + variant + "/room/repeat1/settings.yaml");
    return std::stod(settings.substr(settings.find("Camera.fx: ") + 11));
  };
  EXPECT_NEAR(std::abs(focal_length("good+calibration-0.1") / focal_length("good") - 1.0), 0.1, 1e-9);
  EXPECT_THAT(program_.text("out/tables/robustness.csv"), HasSubstr("\ndropped,,good,0.5,2,2,"));
  EXPECT_THAT(program_.text("out/results.json"), HasSubstr("\"perturbation\": \"dropped-0.5\""));

  // Runs of Holdfast say their SIMD level, others do not: it is no other kind of machine.
  EXPECT_THAT(program_.text("out/cost.md"),
              AllOf(HasSubstr("SIMD level of Holdfast: "), Not(HasSubstr("kinds of machine"))));
  // Nothing is recorded twice, and at the end the copies go.
  const auto time = std::filesystem::last_write_time(program_.path("out/copies/room/none/rgb.txt"));
  std::filesystem::remove_all(program_.path("out/runs/good"));
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "out", "--keep-copies", "--resume"}).exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(program_.path("out/copies/room/none/rgb.txt")), time);
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "out", "--resume"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(program_.path("out/copies")));
  EXPECT_EQ(program_.text("out/tables/runs.csv"), runs);
}

TEST_F(BenchExternalTest, SaysWhichFramesASystemCannotGet) {
  std::string text =
      "axes:\n  perturbation: { both: { perturbation.noise: 5, run.mode: threaded } }\nbase: plain.yaml\n" +
      matrix({"good"});
  text.replace(text.find("sequences: "), std::string::npos,
               "sequences:\n  street: { recipe: kitti_04, path: recording }\n"
               "  little: { source: { tum: { path: recording } }, camera: auto }\n");
  program_.write("plain.yaml", "features: orb\noptimizer: schur\n");
  program_.write("matrix.yaml", text);
  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--dry-run"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(
      outcome.errors,
      AllOf(HasSubstr("sequence 'street' has stereo pairs, and external systems get colour and depth; exclude it"),
            HasSubstr("'both' of the axis 'perturbation' sets 'run.mode', which external systems do not have"),
            HasSubstr("the source 'tum' does not know its own, and the name of the folder 'recording' says none")));
}

/// `camera: auto` is the camera that the folder is named after.
TEST_F(BenchExternalTest, SystemsGetTheCameraOfTheFolder) {
  test::write_listed_recording(program_, "rgbd_dataset_freiburg2_little");
  std::string text = matrix({"good"});
  text.replace(text.find("path: recording"), 15, "path: rgbd_dataset_freiburg2_little");
  text.replace(text.find("camera: tum_fr3"), 15, "camera: auto");
  program_.write("matrix.yaml", text);
  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(program_.text("out/runs/good/little/repeat1/settings.yaml"), HasSubstr("Camera.fx: 520.908"));
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
  EXPECT_THAT(errors({"--statistic", "sigma"}), HasSubstr("sigma"));
  EXPECT_THAT(errors({"--column", "Ours"}), HasSubstr("--column Ours: expected VARIANT=TEXT, such as full=Ours"));
  EXPECT_THAT(errors({"--column", "goood=Ours"}), HasSubstr("there is no variant 'goood'; did you mean 'good'"));
  program_.write("matrix.yaml", "analysis: { statistics: [rsme], columns: { god: Ours } }\n" + matrix({"good"}));
  EXPECT_THAT(errors({}), AllOf(HasSubstr("matrix.yaml:1:26: there is no statistic 'rsme'; did you mean 'rmse'"),
                                HasSubstr("matrix.yaml:1:44: there is no variant 'god'; did you mean 'good'")));
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

/// `mono.yaml` names the camera of another recording.
TEST_F(BenchExternalTest, ARecipeOfPairsReplacesTheCameraOfAConfiguration) {
  std::filesystem::create_directories(program_.path("04/image_0"));
  std::filesystem::create_directories(program_.path("04/image_1"));
  program_.write("04/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 0\nP1: 50 0 32 -25 0 50 24 0 0 0 1 0\n");
  program_.write("04/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  program_.write("04/times.txt", "0\n");
  program_.write("mono.yaml",
                 "source: { tum: { path: recording } }\ncamera: tum_fr1\nsensor: mono\n"
                 "features: orb\noptimizer: schur\n");
  program_.write("matrix.yaml", "base: mono.yaml\nsequences: { street: { recipe: kitti_04, path: 04 } }\n");
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "out"}).exit_code, 0);
  const std::string configuration = program_.text("out/runs/mono/street/seed1-repeat1/config.yaml");
  EXPECT_THAT(configuration, AllOf(HasSubstr("kitti:"), Not(HasSubstr("\ncamera:"))));
}

TEST_F(BenchExternalTest, FindsTheMatricesOfTheProjectSound) {
  // `composed` has two of the five again, with masks by the U-Net.
  for (const auto& [name, variants] : {std::pair{"bonn", 5},
                                       {"composed", 7},
                                       {"euroc", 2},
                                       {"icl_nuim", 2},
                                       {"kitti", 2},
                                       {"robustness", 74},
                                       {"robustness_people", 50},
                                       {"segmenters", 12},
                                       {"simulated", 5},
                                       {"tum_dynamic", 5}}) {
    const Outcome list =
        program_.run({"bench", HOLDFAST_SOURCE_DIR "/benchmarks/" + std::string(name) + ".yaml", "--dry-run"});
    EXPECT_EQ(list.exit_code, 0) << name << "\n" << list.errors;
    EXPECT_THAT(list.output, HasSubstr(" runs: " + std::to_string(variants) + " variants")) << name;
  }
}

TEST_F(BenchExternalTest, ModulesThatDoNotFitAreFoundBeforeAnythingRuns) {
  program_.write(
      "masked.yaml",
      "features: orb\noptimizer: schur\nsegmenter: truth\nfilters:\n  - semantic_mask: { classes: [cat] }\n");
  program_.write("matrix.yaml",
                 "base: masked.yaml\nsequences: { room: { source: { simulated: { duration: 0.1 } } } }\n");
  for (const char* option : {"--dry-run", "--output=out"}) {
    const Outcome outcome = program_.run({"bench", "matrix.yaml", option});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, AllOf(HasSubstr("masked.yaml:5:5: the filter 'semantic_mask' counts the class 'cat'"),
                                      HasSubstr("the segmenter 'truth' has no such class"), HasSubstr("chair")));
  }
  EXPECT_FALSE(std::filesystem::exists(program_.path("out")));
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
