// SPDX-License-Identifier: BSD-3-Clause
// Whole runs around the simulated hall and along the corridor of look-alike desks.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"

namespace holdfast {
namespace {

class LoopRunTest : public ::testing::Test {
 protected:
  nlohmann::json run(const std::string& scene, const std::string& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {
        "run",      std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/rgbd.yaml",
        "--set",    "source.simulated.scene=" + std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/../scenes/" + scene,
        "--set",    "source.simulated.set=[frame_rate=10]",
        "--output", output,
        "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return nlohmann::json::parse(program_.text(output + "/run.json"));
  }

  test::Program program_;
};

// That a run with a loop is the same to the byte on repeat is held by tests/oracle.
TEST_F(LoopRunTest, TheHallIsClosed) {
  const nlohmann::json closed = run("loop.yaml", "closed");
  EXPECT_GE(closed.at("loops").at("closed").size(), 1U);
  EXPECT_EQ(closed.at("frames").at("coverage"), 1.0);
  const double error = closed.at("evaluation").at("ate_m").at("rmse");
  EXPECT_LE(error, 0.03);
  const nlohmann::json open = run("loop.yaml", "open", {"--set", "loop_detector=none"});
  EXPECT_LE(error, 0.6 * open.at("evaluation").at("ate_m").at("rmse").get<double>());
}

TEST_F(LoopRunTest, TheHallIsClosedByImagesAsAWhole) {
  const std::string network = HOLDFAST_PLACE_MODELS "/gist.onnx";
  const nlohmann::json closed = run("loop.yaml", "global",
                                    {"--set", "loop_detector={ global: { model: " + network +
                                                  ", mean: [0, 0, 0], standard_deviation: [1, 1, 1] } }"});
  EXPECT_GE(closed.at("loops").at("closed").size(), 1U);
  EXPECT_LE(closed.at("evaluation").at("ate_m").at("rmse"), 0.03);
}

TEST_F(LoopRunTest, LookAlikeDesksCloseNothing) {
  const nlohmann::json corridor = run("corridor.yaml", "corridor");
  EXPECT_TRUE(corridor.at("loops").at("closed").empty());
  EXPECT_GT(corridor.at("loops").at("verdicts").at("implausible correction"), 0);  // they were looked at
  EXPECT_EQ(corridor.at("frames").at("coverage"), 1.0);
}

}  // namespace
}  // namespace holdfast
