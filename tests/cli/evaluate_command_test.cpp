// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/command.hpp"
#include "evaluation/synthetic_trajectory.hpp"
#include "holdfast/run/trajectory_journal.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Outcome = test::CommandOutcome;

class EvaluateCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("holdfast_evaluate_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const Trajectory truth = test::wavy_trajectory(120, 30.0);
    write_trajectory(path("truth.txt"), truth);
    Trajectory estimate = test::moved(truth, test::some_transform());
    estimate.erase(estimate.begin() + 40, estimate.begin() + 70);
    write_trajectory(path("estimate.txt"), estimate);
    std::ofstream frames(path("frames.txt"));
    frames.precision(17);
    for (const TimedPose& pose : truth) frames << pose.timestamp << " rgb/a.png\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::string content(const char* name) const {
    std::stringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
  static Outcome run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "evaluate");
    return test::run_command(arguments);
  }

  std::filesystem::path folder_;
};

TEST_F(EvaluateCommand, PrintsATableAndWritesFiles) {
  const Outcome outcome = run({path("truth.txt"), path("estimate.txt"), "--frames", path("frames.txt"), "--json",
                               path("figures.json"), "--csv", path("figures.csv"), "--plots", path("new/plots")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("coverage   75.00 %: 90 of 120 frames have a pose; 1 gap, the longest of 30"));
  EXPECT_THAT(outcome.output, HasSubstr("ATE"));
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_EQ(nlohmann::json::parse(content("figures.json"))["coverage"]["poses"], 90);
  EXPECT_THAT(content("figures.csv"), StartsWith("quantity,statistic,value,unit\n"));
  EXPECT_THAT(content("new/plots/trajectory.svg"), StartsWith("<svg"));
  EXPECT_THAT(content("new/plots/error.svg"), HasSubstr("frames without a pose"));
}

TEST_F(EvaluateCommand, PrintsNothingButJsonWhenAsked) {
  const Outcome outcome =
      run({path("truth.txt"), path("estimate.txt"), "--alignment", "sim3", "--delta", "0.5", "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json["alignment"]["kind"], "sim3");
  EXPECT_EQ(json["rpe_per_time"]["step_s"], 0.5);
}

TEST_F(EvaluateCommand, SaysWhatDoesNotCount) {
  std::ofstream(path("estimate.txt"), std::ios::app) << "900 nan 0 0 0 0 0 1\n901 0 0 0 0 0 0 0\n";
  const Outcome outcome = run({path("truth.txt"), path("estimate.txt"), "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.errors, "warning: " + path("estimate.txt") +
                                ": leaves out 1 pose that is not finite, 1 pose with a zero quaternion\n");
  EXPECT_EQ(nlohmann::json::parse(outcome.output)["estimate"]["poses"], 90);
}

TEST_F(EvaluateCommand, TakesAndWritesOtherFormats) {
  const Outcome tum = run({path("truth.txt"), path("estimate.txt"), "--json", "-"});
  const Outcome written = run({path("truth.txt"), path("truth.txt"), "--write", path("poses.csv"), "--write-format",
                               "euroc", "--json", path("ignored.json")});
  EXPECT_EQ(written.exit_code, 0) << written.errors;
  EXPECT_THAT(content("poses.csv"), StartsWith("#timestamp [ns],"));
  const Outcome euroc = run({path("poses.csv"), path("estimate.txt"), "--json", "-"});
  EXPECT_EQ(euroc.exit_code, 0) << euroc.errors;
  const auto rmse = [](const Outcome& outcome) {
    return nlohmann::json::parse(outcome.output).at("ate_m").at("rmse").get<double>();
  };
  EXPECT_NEAR(rmse(tum), rmse(euroc), 1e-6);
  const Outcome refused = run({path("poses.csv"), path("estimate.txt"), "--format", "tum"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.errors, HasSubstr("it looks like EuRoC's format"));

  std::ofstream(path("matrices.txt")) << trajectory_text(read_trajectory(path("truth.txt")), TrajectoryFormat::kitti);
  std::ofstream times(path("times.txt"));
  times.precision(17);
  for (const TimedPose& pose : read_trajectory(path("truth.txt"))) times << pose.timestamp << "\n";
  times.close();
  const Outcome kitti = run({path("matrices.txt"), path("estimate.txt"), "--times", path("times.txt"), "--json", "-"});
  EXPECT_EQ(kitti.exit_code, 0) << kitti.errors;
  EXPECT_NEAR(rmse(tum), rmse(kitti), 1e-6);
  const Outcome without = run({path("matrices.txt"), path("matrices.txt"), "--json", "-"});
  EXPECT_THAT(without.errors, HasSubstr("ten poses a second are assumed"));
}

TEST_F(EvaluateCommand, ComparesSeveralEstimates) {
  write_trajectory(path("good.txt"), test::moved(test::wavy_trajectory(120, 30.0), test::some_transform()));
  write_trajectory(path("later.txt"), test::wavy_trajectory(50, 30.0, 900.0));
  const std::vector<std::string> two = {path("truth.txt"), path("estimate.txt"), path("good.txt"), "--frames",
                                        path("frames.txt")};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = two;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  const Outcome table = with({});
  EXPECT_EQ(table.exit_code, 0) << table.errors;
  EXPECT_THAT(table.errors, IsEmpty());
  EXPECT_THAT(table.output, ::testing::ContainsRegex("estimate.txt +90 +90 +75.00 +0.000000"));
  EXPECT_THAT(table.output, ::testing::ContainsRegex("good.txt +120 +120 +100.00 +0.000000"));
  const auto json = nlohmann::json::parse(with({"--json", "-"}).output);
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[1]["estimate"]["name"], path("good.txt"));
  EXPECT_EQ(json[0]["coverage"]["poses"], 90);
  const std::string csv = with({"--csv", "-"}).output;
  EXPECT_THAT(csv,
              StartsWith("estimate,quantity,statistic,value,unit\n" + path("estimate.txt") + ",alignment,kind,se3,"));
  EXPECT_THAT(csv, HasSubstr(path("good.txt") + ",pairing,pairs,120,"));

  // One that fails does not take the others with it.
  const Outcome partly = with({path("later.txt"), path("absent.txt"), "--json", path("figures.json")});
  EXPECT_EQ(partly.exit_code, 1);
  EXPECT_THAT(partly.errors, AllOf(HasSubstr("later.txt holds 50 poses"), HasSubstr("absent.txt: no such file")));
  EXPECT_THAT(partly.output, AllOf(::testing::ContainsRegex("good.txt +120"), HasSubstr("later.txt")));
  EXPECT_THAT(nlohmann::json::parse(content("figures.json"))[2].at("error"), HasSubstr("found 0 pairs"));
  EXPECT_THAT(with({"--plots", path("plots")}).errors, HasSubstr("--plots and --write are of one estimate"));
}

TEST_F(EvaluateCommand, NamesTheJournalOfAKilledRun) {
  {
    TrajectoryJournal journal(folder_);
    for (const TimedPose& pose : read_trajectory(path("estimate.txt"))) journal.add(pose);
  }
  const Outcome outcome = run({path("truth.txt"), path("trajectory.txt"), "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, HasSubstr("trajectory.txt: is of a run that has not come to its end: 90 poses"));
}

TEST_F(EvaluateCommand, WarnsAndTheOptionItNamesMends) {
  const Trajectory truth = test::wavy_trajectory(3000, 100.0);
  const Trajectory estimate = test::moved(test::wavy_trajectory(900, 30.0), test::some_transform());
  write_trajectory(path("moved.txt"), estimate);
  const auto expect_mended = [&](const Trajectory& given_truth, const std::string& suspicion,
                                 const std::vector<std::string>& options) {
    write_trajectory(path("given.txt"), given_truth);
    const Outcome wrong = run({path("given.txt"), path("moved.txt"), "--json", "-"});
    EXPECT_EQ(wrong.exit_code, 0);
    EXPECT_THAT(wrong.errors, HasSubstr(suspicion));
    for (const std::string& option : options) EXPECT_THAT(wrong.errors, HasSubstr(option));
    std::vector<std::string> arguments = {path("given.txt"), path("moved.txt"), "--json", "-"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome mended = run(arguments);
    EXPECT_THAT(mended.errors, IsEmpty()) << suspicion;
    const auto json = nlohmann::json::parse(mended.output);
    EXPECT_LT(json["ate_m"]["rmse"].get<double>(), 0.005) << suspicion;
    EXPECT_LT(json["rpe_per_time"]["rotation_deg"]["rmse"].get<double>(), 0.3) << suspicion;
  };
  const auto changed = [&](const auto& change) {
    Trajectory result = truth;
    for (TimedPose& pose : result) change(pose);
    return result;
  };
  expect_mended(changed([](TimedPose& pose) { pose.timestamp += 0.15; }), "given.txt is late",
                {"--time-offset", "0.150"});
  expect_mended(changed([](TimedPose& pose) { pose.T_world_camera.translation() *= 1000.0; }), "millimetres",
                {"--truth-unit", "mm"});
  expect_mended(
      changed([](TimedPose& pose) { pose.T_world_camera = Eigen::Isometry3d(pose.T_world_camera.inverse()); }),
      "inverted", {"--invert", "truth"});
  expect_mended(changed([](TimedPose& pose) {
                  const Eigen::DiagonalMatrix<double, 3> mirror(1.0, -1.0, 1.0);
                  pose.T_world_camera.linear() = (mirror * pose.T_world_camera.linear() * mirror).eval();
                  pose.T_world_camera.translation().y() *= -1.0;
                }),
                "left-handed", {"--mirror", "y"});

  // A mirrored estimate, which is given second.
  Trajectory mirrored = read_trajectory(path("moved.txt"));
  const Eigen::DiagonalMatrix<double, 3> mirror(1.0, 1.0, -1.0);
  for (TimedPose& pose : mirrored) {
    pose.T_world_camera.linear() = (mirror * pose.T_world_camera.linear() * mirror).eval();
    pose.T_world_camera.translation().z() *= -1.0;
  }
  write_trajectory(path("mirrored.txt"), mirrored);
  write_trajectory(path("given.txt"), truth);
  EXPECT_THAT(run({path("given.txt"), path("mirrored.txt")}).errors, HasSubstr("`--mirror-estimate z`"));
  const Outcome mended = run({path("given.txt"), path("mirrored.txt"), "--mirror-estimate", "z", "--json", "-"});
  EXPECT_THAT(mended.errors, IsEmpty());
  EXPECT_LT(nlohmann::json::parse(mended.output)["rpe_per_time"]["rotation_deg"]["rmse"].get<double>(), 0.3);

  write_trajectory(path("given.txt"), changed([](TimedPose& pose) { pose.timestamp += 3.2; }));
  const Outcome found = run({path("given.txt"), path("moved.txt"), "--time-offset", "estimate"});
  EXPECT_THAT(found.errors, IsEmpty());
  EXPECT_THAT(found.output, HasSubstr("clocks     3.2000 s added to the stamps of the estimate"));
  const Outcome apart = run({path("given.txt"), path("moved.txt"), "--time-offset", "900"});
  EXPECT_EQ(apart.exit_code, 1);
  write_trajectory(path("short.txt"), test::wavy_trajectory(12, 30.0, 105.0));
  const Outcome none = run({path("given.txt"), path("short.txt"), "--time-offset", "estimate"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.errors, HasSubstr("no time offset of"));
  EXPECT_EQ(run({path("given.txt"), path("moved.txt"), "--time-offset", "soon"}).exit_code, 2);
}

TEST_F(EvaluateCommand, ExplainsFailureAndReturnsNonZero) {
  const Outcome missing = run({path("absent.txt"), path("estimate.txt")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.output, IsEmpty());
  EXPECT_THAT(missing.errors, HasSubstr("error: " + path("absent.txt") + ": no such file"));

  write_trajectory(path("later.txt"), test::wavy_trajectory(50, 30.0, 900.0));
  const Outcome apart = run({path("truth.txt"), path("later.txt"), "--json", path("figures.json")});
  EXPECT_EQ(apart.exit_code, 1);
  EXPECT_THAT(apart.errors, HasSubstr("later.txt holds 50 poses from 900.000000"));
  EXPECT_FALSE(std::filesystem::exists(path("figures.json")));
}

TEST_F(EvaluateCommand, UsageErrorsExitWith2) {
  const auto errors = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {path("truth.txt"), path("estimate.txt")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, AllOf(StartsWith("error: "), HasSubstr("see `holdfast evaluate --help`")));
    return outcome.errors;
  };
  errors({"--alignment", "so3"});
  EXPECT_THAT(errors({"--json", "-", "--csv", "-"}), HasSubstr("cannot both go to standard output"));
  for (const char* option : {"--max-dt", "--delta", "--distance"})
    for (const char* value : {"-1", "0", "nan", "inf", "1x"}) {
      const std::string text = errors({option, value});
      EXPECT_THAT(text, HasSubstr(std::string("found '") + value + "'; expected a number above 0"));
      EXPECT_LT(text.size(), 150U);  // not the largest of all numbers with its 309 digits
    }
  EXPECT_THAT(errors({"--alingment", "se3"}),
              HasSubstr("there is no option '--alingment'; did you mean '--alignment'?"));
  EXPECT_EQ(run({"-", "-"}).exit_code, 2);
}

TEST_F(EvaluateCommand, AsksBeforeItReplacesAFile) {
  for (const char* option : {"--json", "--csv", "--plots"}) {
    const bool is_folder = std::string(option) == "--plots";
    const std::string target = path(is_folder ? "." : "figures");
    std::ofstream(path(is_folder ? "error.svg" : "figures")) << "precious";
    const Outcome refused = run({path("truth.txt"), path("estimate.txt"), option, target});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.errors, HasSubstr("is there already; name another file, or add --overwrite"));
    EXPECT_EQ(refused.output, "");
    EXPECT_EQ(content(is_folder ? "error.svg" : "figures"), "precious");
    EXPECT_EQ(run({path("truth.txt"), path("estimate.txt"), option, target, "--overwrite"}).exit_code, 0);
    EXPECT_NE(content(is_folder ? "error.svg" : "figures"), "precious");
  }
}

TEST_F(EvaluateCommand, RefusesANamedPipe) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(run({path("pipe"), path("estimate.txt")}).errors, HasSubstr("pipe: found a named pipe"));
  EXPECT_THAT(run({path("truth.txt"), path("pipe")}).errors, HasSubstr("pipe: found a named pipe"));
  const Outcome frames = run({path("truth.txt"), path("estimate.txt"), "--frames", path("pipe")});
  EXPECT_EQ(frames.exit_code, 1);
  EXPECT_THAT(frames.errors, HasSubstr("pipe: found a named pipe"));
}

}  // namespace
}  // namespace holdfast
