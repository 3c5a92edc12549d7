// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_command.hpp"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "evaluation/synthetic_trajectory.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

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
    Outcome outcome;
    CLI::App app{"program"};
    add_evaluate_command(app, outcome.exit_code);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    arguments.push_back("evaluate");
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    try {
      app.parse(arguments);
    } catch (const CLI::ParseError& error) {
      outcome.exit_code = app.exit(error);
    }
    outcome.output = ::testing::internal::GetCapturedStdout();
    outcome.errors = ::testing::internal::GetCapturedStderr();
    return outcome;
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
  EXPECT_THAT(content("new/plots/top_view.svg"), StartsWith("<svg"));
  EXPECT_THAT(content("new/plots/error_over_time.svg"), HasSubstr("frames without a pose"));
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
  EXPECT_EQ(outcome.errors, "holdfast evaluate: " + path("estimate.txt") +
                                ": leaves out 1 pose that is not finite, 1 pose with a zero quaternion\n");
  EXPECT_EQ(nlohmann::json::parse(outcome.output)["estimate"]["poses"], 90);
}

TEST_F(EvaluateCommand, ExplainsFailureAndReturnsNonZero) {
  const Outcome missing = run({path("absent.txt"), path("estimate.txt")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.output, IsEmpty());
  EXPECT_THAT(missing.errors, HasSubstr("absent.txt: no such file"));

  write_trajectory(path("later.txt"), test::wavy_trajectory(50, 30.0, 900.0));
  const Outcome apart = run({path("truth.txt"), path("later.txt"), "--json", path("figures.json")});
  EXPECT_EQ(apart.exit_code, 1);
  EXPECT_THAT(apart.errors, HasSubstr("later.txt holds 50 poses from 900.000000"));
  EXPECT_FALSE(std::filesystem::exists(path("figures.json")));

  EXPECT_NE(run({path("truth.txt"), path("estimate.txt"), "--alignment", "so3"}).exit_code, 0);
  EXPECT_NE(run({path("truth.txt"), path("estimate.txt"), "--max-dt", "-1"}).exit_code, 0);
  EXPECT_EQ(run({path("truth.txt"), path("estimate.txt"), "--json", "-", "--csv", "-"}).exit_code, 1);
}

}  // namespace
}  // namespace holdfast
