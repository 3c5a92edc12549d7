// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/program.hpp"
#include "holdfast/core/simd.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class RunTest : public ::testing::Test {
 protected:
  RunTest() {
    program_.write("room.yaml",
                   "source: { simulated: { duration: 0.5 } }\ncamera: tum_fr1\nfeatures: { orb: { count: 600 } "
                   "}\noptimizer: ceres\n");
    program_.write("recording.yaml",
                   "source: { tum: { path: recording } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n");
  }
  nlohmann::json summary(const std::string& folder) const {
    return nlohmann::json::parse(program_.text(folder + "/run.json"));
  }

  /// Fifteen frames of the room, of which the tenth colour image is cut short.
  void record_with_a_damaged_image() {
    const Outcome outcome = program_.run({"simulate", "--output", "recording", "--duration", "0.5"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(program_.path("recording/rgb"))) images.push_back(entry.path());
    std::sort(images.begin(), images.end());
    ASSERT_EQ(images.size(), 15U);
    fs::resize_file(images[9], fs::file_size(images[9]) / 2);
    damaged_ = images[9].filename().string();
  }

  /// Starts a run of ten minutes, and returns when it has poses.
  pid_t start_long_run(const std::string& folder, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", "room.yaml", "--set", "source.simulated.duration=600", "-o", folder};
    words.insert(words.end(), more.begin(), more.end());
    const pid_t process = program_.start(words);
    program_.wait_for_poses(process, folder);
    return process;
  }

  test::Program program_;
  std::string damaged_;
};

TEST_F(RunTest, WritesItsResults) {
  const Outcome outcome = program_.run({"run", "room.yaml", "--output", "deep/out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("coverage"), HasSubstr("ATE RMSE"), HasSubstr("median ms")));
  for (const char* name :
       {"trajectory.txt", "keyframes.txt", "run.json", "report.html", "config.yaml", "evaluation.json", "tracks.json",
        "trajectory.svg", "error.svg", "map.hfm", "static_map.ply"})
    EXPECT_GT(fs::file_size(program_.path(std::string("deep/out/") + name)), 20U) << name;
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(program_.path("deep/out"))) ++files;
  EXPECT_EQ(files, 11U);  // nothing half-written is left

  const nlohmann::json run = summary("deep/out");
  EXPECT_EQ(run.at("frames").at("coverage"), 1.0);
  EXPECT_EQ(run.at("frames").at("expected"), 15);
  EXPECT_EQ(run.at("frames").at("poses"), 15);
  EXPECT_EQ(run.at("frames").at("skipped"), 0);
  EXPECT_EQ(run.at("health").at("good"), 15);
  EXPECT_EQ(run.at("interrupted"), false);
  EXPECT_TRUE(run.at("failure").is_null());
  EXPECT_LT(run.at("evaluation").at("ate_m").at("rmse"), 0.006);
  const std::string trajectory = program_.text("deep/out/trajectory.txt");
  EXPECT_EQ(lines(trajectory) - static_cast<std::size_t>(trajectory.find('#') == 0 ? 1 : 0), 15U);
  const std::string report = program_.text("deep/out/report.html");
  EXPECT_THAT(report, AllOf(HasSubstr("<svg"), HasSubstr("ATE RMSE"), HasSubstr("local map"), HasSubstr("</html>")));
}

TEST_F(RunTest, GivesTheSameBytesAgainAndFromItsOwnConfiguration) {
  ASSERT_EQ(program_.run({"run", "room.yaml", "--set", "run.seed=5", "--output", "a", "--quiet"}).exit_code, 0);
  const Outcome quiet = program_.run({"run", "room.yaml", "--set", "run.seed=5", "--output", "b", "--quiet"});
  ASSERT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.output + quiet.errors, "");
  ASSERT_EQ(program_.run({"run", "a/config.yaml", "--output", "c"}).exit_code, 0);
  ASSERT_EQ(program_.run({"run", "room.yaml", "--set", "run.seed=6", "--output", "d"}).exit_code, 0);
  const std::string first = program_.text("a/trajectory.txt");
  EXPECT_GT(first.size(), 500U);
  EXPECT_EQ(program_.text("b/trajectory.txt"), first);
  EXPECT_EQ(program_.text("c/trajectory.txt"), first);
  EXPECT_NE(program_.text("d/trajectory.txt"), first);
  EXPECT_EQ(program_.text("b/keyframes.txt"), program_.text("a/keyframes.txt"));
}

TEST_F(RunTest, GivesTheSameBytesAtEverySimdLevel) {
  for (const SimdLevel each : simd_levels) {
    const char* level = to_string(each);
    ASSERT_EQ(setenv("HOLDFAST_SIMD", level, 1), 0);
    const Outcome outcome = program_.run({"run", "room.yaml", "--output", level, "--quiet"});
    ASSERT_EQ(unsetenv("HOLDFAST_SIMD"), 0);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
  EXPECT_EQ(summary("scalar").at("machine").at("simd"), "scalar");
  for (const SimdLevel level : simd_levels)
    EXPECT_EQ(program_.text(std::string(to_string(level)) + "/trajectory.txt"), program_.text("scalar/trajectory.txt"))
        << to_string(level);
}

TEST_F(RunTest, LeavesEarlierResultsAlone) {
  fs::create_directory(program_.path("out"));
  program_.write("out/trajectory.txt", "precious");
  program_.write("out/notes.txt", "mine");
  const Outcome refused = program_.run({"run", "room.yaml", "--output", "out"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("out: the output folder is not empty"), HasSubstr("--overwrite")));
  EXPECT_EQ(program_.text("out/trajectory.txt"), "precious");
  EXPECT_FALSE(fs::exists(program_.path("out/config.yaml")));
  ASSERT_EQ(program_.run({"run", "room.yaml", "--output", "out", "--overwrite", "--set", "observers=[mcap]"}).exit_code,
            0);
  EXPECT_NE(program_.text("out/trajectory.txt"), "precious");
  EXPECT_EQ(program_.text("out/notes.txt"), "mine");
  EXPECT_GT(fs::file_size(program_.path("out/run.mcap")),
            10000U);  // begun during the run, after the earlier results went
}

TEST_F(RunTest, TwoRunsDoNotShareAFolder) {
  const pid_t first =
      program_.start({"run", "room.yaml", "--set", "source.simulated.duration=600", "--output", "out", "--quiet"});
  for (int i = 0; i < 3000 && !fs::exists(program_.path("out/config.yaml")); ++i) usleep(10'000);
  // Its output goes elsewhere than that of the first, which program_ keeps.
  const test::Program other;
  const Outcome second = other.run(
      {"run", program_.path("room.yaml"), "--overwrite", "--output", program_.path("out").string(), "--quiet"});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.errors, AllOf(HasSubstr("another process is writing into this folder"), HasSubstr("wait for")));
  EXPECT_TRUE(fs::exists(program_.path("out/config.yaml"))) << "nothing of the first is removed";
  kill(first, SIGTERM);
  EXPECT_EQ(program_.finish(first).exit_code, 143);
  EXPECT_EQ(program_.run({"run", "room.yaml", "--overwrite", "--output", "out", "--quiet"}).exit_code, 0);
}

TEST_F(RunTest, SwapsTheFeatures) {
  const Outcome outcome = program_.run({"run", "room.yaml", "--set", "features=opencv_orb", "--output", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(summary("out").at("frames").at("coverage"), 1.0);
  EXPECT_THAT(program_.text("out/config.yaml"), HasSubstr("\nfeatures:\n  opencv_orb:\n"));
}

TEST_F(RunTest, KeepsWhatWasDoneBeforeADamagedImage) {
  record_with_a_damaged_image();
  const Outcome outcome = program_.run({"run", "recording.yaml", "--output", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("error: "), HasSubstr(damaged_)));
  const nlohmann::json run = summary("out");
  EXPECT_EQ(run.at("frames").at("poses"), 9);
  EXPECT_EQ(run.at("frames").at("expected"), 15);
  EXPECT_NEAR(run.at("frames").at("coverage"), 9.0 / 15.0, 1e-12);
  EXPECT_EQ(run.at("evaluation").at("coverage").at("frames"), 15);  // those that never came are missing, too
  EXPECT_EQ(run.at("evaluation").at("coverage").at("poses"), 9);
  EXPECT_EQ(run.at("evaluation").at("coverage").at("longest_gap_frames"), 6);
  EXPECT_THAT(run.at("failure").get<std::string>(), HasSubstr(damaged_));
  EXPECT_THAT(program_.text("out/report.html"), HasSubstr("ended before its time"));
  EXPECT_GT(program_.text("out/trajectory.txt").size(), 300U);
}

TEST_F(RunTest, SkipsDamagedImagesWhereAllowed) {
  record_with_a_damaged_image();
  const Outcome outcome =
      program_.run({"run", "recording.yaml", "--set", "source.tum.on_bad_frame=skip", "--output", "out"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("1 skipped"));
  const nlohmann::json run = summary("out");
  EXPECT_EQ(run.at("frames").at("skipped"), 1);
  EXPECT_EQ(run.at("frames").at("poses"), 14);
  EXPECT_NEAR(run.at("frames").at("coverage"), 14.0 / 15.0, 1e-12);
  EXPECT_EQ(run.at("evaluation").at("coverage").at("frames"), 15);
  EXPECT_EQ(run.at("evaluation").at("coverage").at("poses"), 14);
  EXPECT_EQ(run.at("evaluation").at("coverage").at("longest_gap_frames"), 1);
  ASSERT_EQ(run.at("skipped_frames").size(), 1U);
  EXPECT_EQ(run.at("skipped_frames").at(0).at("index"), 9);
  EXPECT_THAT(run.at("skipped_frames").at(0).at("reason").get<std::string>(), HasSubstr(damaged_));
}

TEST_F(RunTest, KeepsWhatWasDoneWhenInterrupted) {
  const pid_t process =
      program_.start({"run", "room.yaml", "--set", "source.simulated.duration=600", "--output", "out"});
  program_.wait_for_poses(process, "out");
  kill(process, SIGINT);
  const Outcome outcome = program_.finish(process);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("interrupted; what was done is in out"));
  const nlohmann::json run = summary("out");
  EXPECT_EQ(run.at("interrupted"), true);
  EXPECT_EQ(run.at("frames").at("expected"), 18000);
  const std::size_t poses = run.at("frames").at("poses");
  EXPECT_GT(poses, 0U);
  EXPECT_LT(poses, 18000U);
  EXPECT_GE(lines(program_.text("out/trajectory.txt")), poses);
}

TEST_F(RunTest, AHangupEndsItAsSigtermDoes) {
  for (const int signal : {SIGTERM, SIGHUP}) {
    const std::string folder = "out" + std::to_string(signal);
    const pid_t process = start_long_run(folder);
    kill(process, signal);
    const Outcome outcome = program_.finish(process);
    EXPECT_EQ(outcome.exit_code, 143) << outcome.errors;
    EXPECT_EQ(summary(folder).at("interrupted"), true);
    EXPECT_TRUE(fs::exists(program_.path(folder + "/map.hfm")));
  }
  // Under nohup it goes on.
  const auto before = std::signal(SIGHUP, SIG_IGN);
  const pid_t process = start_long_run("ignored");
  std::signal(SIGHUP, before);
  kill(process, SIGHUP);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(waitpid(process, nullptr, WNOHANG), 0) << "still runs";
  kill(process, SIGTERM);
  EXPECT_EQ(program_.finish(process).exit_code, 143);
}

TEST_F(RunTest, AKilledRunLeavesItsPosesAndSaysSo) {
  const pid_t process = start_long_run("out");
  program_.wait_for_poses(process, "out", 5);
  kill(process, SIGKILL);
  EXPECT_EQ(program_.finish(process).exit_code, 1000 + SIGKILL);
  EXPECT_FALSE(fs::exists(program_.path("out/run.json")));
  EXPECT_THAT(program_.text("out/trajectory.txt"), testing::StartsWith("# The run has not come to its end"));
  program_.write("out/trajectory.txt.tmp", "half");  // as of a run that was killed while it wrote its results
  const Outcome refused = program_.run({"run", "room.yaml", "--output", "out"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("holds a run that was killed, with "),
                                    HasSubstr("poses in trajectory.txt"), HasSubstr("--overwrite")));
  ASSERT_EQ(program_.run({"run", "room.yaml", "--output", "out", "--overwrite"}).exit_code, 0);
  EXPECT_EQ(summary("out").at("frames").at("poses"), 15);
  EXPECT_EQ(lines(program_.text("out/trajectory.txt")), 16U);
  EXPECT_FALSE(fs::exists(program_.path("out/trajectory.txt.tmp")));
}

TEST_F(RunTest, LowCoverageIsAWarningAndAFailureWhenStrict) {
  record_with_a_damaged_image();
  const std::vector<std::string> run = {"run",         "recording.yaml", "--set", "source.tum.on_bad_frame=skip",
                                        "--overwrite", "--output",       "out"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    return program_.run(more);
  };
  const Outcome enough = with({"--strict"});
  EXPECT_EQ(enough.exit_code, 0);
  EXPECT_EQ(enough.errors, "");
  const std::string warning = "14 of 15 frames have a pose (93.33 %), less than run.minimum_coverage 95.00 %";
  const Outcome warned = with({"--set", "run.minimum_coverage=0.95"});
  EXPECT_EQ(warned.exit_code, 0);
  EXPECT_THAT(warned.errors,
              AllOf(HasSubstr("warning: " + warning), HasSubstr("The commonest trouble: 1 frame skipped")));
  const Outcome strict = with({"--set", "run.minimum_coverage=0.95", "--strict"});
  EXPECT_EQ(strict.exit_code, 3);
  EXPECT_THAT(strict.errors, HasSubstr("error: " + warning));
  EXPECT_THAT(program_.text("out/report.html"), HasSubstr("highlight alarming"));
}

TEST_F(RunTest, TheLastLineNamesTheReport) {
  const Outcome outcome = program_.run({"run", "room.yaml", "-o", "deep/out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(outcome.output.ends_with("\nreport               deep/out/report.html\n")) << outcome.output;
  const Outcome quiet = program_.run({"run", "room.yaml", "-q", "-o", "quiet"});
  EXPECT_EQ(quiet.output + quiet.errors, "");
}

TEST_F(RunTest, ThreadsHaveNames) {
  const pid_t process = start_long_run("out", {"--set", "run.mode=threaded"});
  std::string names;
  std::error_code gone;
  for (const auto& thread : fs::directory_iterator("/proc/" + std::to_string(process) + "/task", gone))
    names += test::content(thread.path() / "comm");
  kill(process, SIGTERM);
  program_.finish(process);
  EXPECT_THAT(names, AllOf(HasSubstr("frame source\n"), HasSubstr("local mapping\n")));
}

TEST_F(RunTest, ThreadsTrackEveryFrameAndTellWhatTheyDid) {
  const Outcome outcome =
      program_.run({"run", "room.yaml", "--set", "run.mode=threaded", "--set", "loop_detector=flann", "--set",
                    "source.simulated.duration=2", "--output", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("frame to result"), HasSubstr("mapping: bundle adjustment")));
  const nlohmann::json run = summary("out");
  EXPECT_EQ(run.at("mode"), "threaded");
  EXPECT_EQ(run.at("frames").at("poses"), 60);
  EXPECT_LT(run.at("evaluation").at("ate_m").at("rmse"), 0.006);
  EXPECT_EQ(run.at("threads").at("frames").at("taken"), 60);
  const nlohmann::json& delays = run.at("threads").at("frame_to_result");
  EXPECT_EQ(delays.at("share_above_33_ms") == 0.0, delays.at("maximum_s") <= 0.033);
  EXPECT_EQ(run.at("masks").at("count"), 0);
  EXPECT_EQ(run.at("threads").at("workers").at(0).at("name"), "local mapping");
  EXPECT_EQ(run.at("threads").at("workers").at(0).at("queue").at("taken"), run.at("map").at("keyframes_made"));
  EXPECT_TRUE(summary("out").at("loops").at("closed").empty());
  EXPECT_THAT(program_.text("out/report.html"), HasSubstr("Queues between threads"));
}

TEST_F(RunTest, SaysHowOldMasksWereWhenTheyCame) {
  const Outcome outcome =
      program_.run({"run", "room.yaml", "--set", "segmenter=truth", "--set", "segmentation.latency=3", "--set",
                    "source.simulated.duration=1", "--output", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("100 ms old when they came (median)"));
  const nlohmann::json run = summary("out");
  EXPECT_GT(run.at("masks").at("count"), 0);
  EXPECT_NEAR(run.at("masks").at("median_age_s").get<double>(), 0.1, 1e-6);
}

TEST_F(RunTest, ThreadsStopWhenInterrupted) {
  const pid_t process =
      program_.start({"run", "room.yaml", "--set", "source.simulated.duration=600", "--set", "run.mode=threaded",
                      "--set", "run.pace=timestamps", "--set", "run.late_frames=drop", "--output", "out"});
  program_.wait_for_poses(process, "out");
  kill(process, SIGINT);
  const Outcome outcome = program_.finish(process);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.errors;
  EXPECT_EQ(summary("out").at("interrupted"), true);
  EXPECT_GT(summary("out").at("frames").at("poses"), 0U);
  EXPECT_TRUE(fs::exists(program_.path("out/map.hfm")));
}

TEST_F(RunTest, AMapIsLocalisedInAndContinued) {
  ASSERT_EQ(program_
                .run({"run", "room.yaml", "--set", "loop_detector=flann", "--set", "source.simulated.duration=3",
                      "--output", "made", "--quiet"})
                .exit_code,
            0);
  const std::string map = program_.text("made/map.hfm");
  const auto run = [&](const std::string& folder, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"run",      "room.yaml",
                                          "--set",    "loop_detector=flann",
                                          "--set",    "source.simulated.path=rpy",
                                          "--map",    "made/map.hfm",
                                          "--output", folder,
                                          "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return program_.run(arguments);
  };
  Outcome outcome = run("where", {"--localise"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  nlohmann::json result = summary("where");
  EXPECT_EQ(result.at("frames").at("poses"), 15);
  EXPECT_EQ(result.at("frames").at("relocalised"), 1);
  EXPECT_LT(result.at("evaluation").at("ate_m").at("rmse"), 0.006);
  EXPECT_EQ(result.at("map").at("keyframes_made"), 0);
  EXPECT_FALSE(fs::exists(program_.path("where/map.hfm")));

  outcome = run("more", {"--set", "source.simulated.duration=3"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  result = summary("more");
  EXPECT_EQ(result.at("frames").at("poses"), 90);
  EXPECT_GT(result.at("map").at("keyframes_made"), 0);
  EXPECT_TRUE(fs::exists(program_.path("more/map.hfm")));
  EXPECT_EQ(program_.text("made/map.hfm"), map);  // nobody has touched it
  // The same again, to the byte.
  ASSERT_EQ(run("again", {"--set", "source.simulated.duration=3"}).exit_code, 0);
  EXPECT_EQ(program_.text("again/trajectory.txt"), program_.text("more/trajectory.txt"));
  EXPECT_EQ(program_.text("again/map.hfm"), program_.text("more/map.hfm"));
}

TEST_F(RunTest, FramesBetweenKeyframesCanBeTrackedByFlow) {
  const auto run = [&](const std::string& folder, const std::string& between) {
    const Outcome outcome = program_.run({"run", "room.yaml", "--set", "tracking.between_keyframes=" + between, "--set",
                                          "source.simulated.duration=4", "--output", folder, "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  };
  run("features", "features");
  EXPECT_EQ(summary("features").at("frames").at("by_flow"), 0);
  run("flow", "flow");
  const nlohmann::json frames = summary("flow").at("frames");
  EXPECT_EQ(frames.at("coverage"), 1.0);
  EXPECT_GT(frames.at("by_flow").get<int>(), frames.at("fed").get<int>() / 2);
  EXPECT_LT(summary("flow").at("evaluation").at("ate_m").at("rmse").get<double>(),
            0.002 + summary("features").at("evaluation").at("ate_m").at("rmse").get<double>());
  run("again", "flow");
  EXPECT_EQ(program_.text("again/trajectory.txt"), program_.text("flow/trajectory.txt"));
  EXPECT_EQ(program_.text("again/map.hfm"), program_.text("flow/map.hfm"));
}

TEST_F(RunTest, AMapKeepsTheDescriptionsOfItsImages) {
  const auto detector = [](const std::string& more) {
    return std::string("loop_detector={ global: { model: " HOLDFAST_PLACE_MODELS "/gist.onnx, mean: [0, 0, 0], ") +
           "standard_deviation: [1, 1, 1]" + more + " } }";
  };
  for (const auto& [folder, setting] : {std::pair("described", detector("")), {"words", "loop_detector=flann"}})
    ASSERT_EQ(program_
                  .run({"run", "room.yaml", "--set", setting, "--set", "source.simulated.duration=3", "--output",
                        folder, "--quiet"})
                  .exit_code,
              0);
  const auto localise = [&](const std::string& map, const std::string& setting) {
    return program_.run({"run", "room.yaml", "--set", setting, "--set", "source.simulated.path=rpy", "--map", map,
                         "--localise", "--output", "where", "--quiet", "--overwrite"});
  };
  const Outcome found = localise("described/map.hfm", detector(""));
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  EXPECT_EQ(summary("where").at("frames").at("poses"), 15);
  EXPECT_EQ(summary("where").at("frames").at("relocalised"), 1);
  // Words do without descriptions, and descriptions cannot do without.
  EXPECT_EQ(localise("described/map.hfm", "loop_detector=flann").exit_code, 0);
  EXPECT_THAT(
      localise("words/map.hfm", detector("")).errors,
      HasSubstr("words/map.hfm: holds no descriptions of its keyframes' images, which the loop detector 'global'"));
}

TEST_F(RunTest, AMapThatCannotBeUsedIsAClearError) {
  ASSERT_EQ(program_.run({"run", "room.yaml", "--output", "made", "--quiet"}).exit_code, 0);
  const std::vector<std::string> run = {"run", "room.yaml", "--output", "out", "--map"};
  const auto errors = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = run;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = program_.run(arguments);
    EXPECT_NE(outcome.exit_code, 0);
    return outcome.errors;
  };
  EXPECT_THAT(errors({"made/map.hfm"}), HasSubstr("the loop detector is 'none'"));
  EXPECT_THAT(errors({"absent.hfm", "--set", "loop_detector=flann"}), HasSubstr("absent.hfm"));
  EXPECT_THAT(errors({"room.yaml", "--set", "loop_detector=flann"}), HasSubstr("room.yaml"));
  EXPECT_THAT(errors({"made/map.hfm", "--set", "loop_detector=flann", "--set", "camera=tum_fr2"}),
              AllOf(HasSubstr("made/map.hfm: was made with the camera 'tum_fr1'"), HasSubstr("'tum_fr2'")));
  EXPECT_FALSE(fs::exists(program_.path("out")));
  const std::string map = program_.text("made/map.hfm");
  EXPECT_THAT(program_.run({"run", "room.yaml", "--map", "made/map.hfm", "--output", "made", "--overwrite"}).errors,
              HasSubstr("made/map.hfm: lies in the output folder"));
  EXPECT_EQ(program_.text("made/map.hfm"), map);
  EXPECT_THAT(program_.run({"run", "room.yaml", "--localise", "--output", "out"}).errors, HasSubstr("--map"));
}

TEST_F(RunTest, FailsWhenNothingCanBeSeen) {
  // A camera for which no feature exists: the run ends, and says why it is no success.
  const Outcome outcome =
      program_.run({"run", "room.yaml", "--set", "tracking.minimum_start_points=5000", "--output", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("error: no frame got a pose"));
  EXPECT_EQ(summary("out").at("frames").at("coverage"), 0.0);
}

}  // namespace
}  // namespace holdfast
