// SPDX-License-Identifier: BSD-3-Clause
// Lenses from the renderer to the trajectory and the map file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

const std::string numbers = "width: 640, height: 480, cx: 319.5, cy: 239.5, ";

class LensRun : public testing::TestWithParam<std::string> {};

TEST_P(LensRun, DepthAndOneCameraAreTrackedToMillimetres) {
  const test::Program program;
  for (const std::string sensor : {"rgbd", "mono"}) {
    const test::Outcome outcome = program.run(
        {"run", std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/mono.yaml", "--set", "sensor=" + sensor, "--set",
         "source={simulated: {path: xyz, duration: 3, seed: 1}}", "--set", "camera={" + numbers + GetParam() + "}",
         "--set", "features.orb.count=1000", "--output", sensor, "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const nlohmann::json summary = nlohmann::json::parse(program.text(sensor + "/run.json"));
    EXPECT_GE(summary.at("frames").at("poses"), sensor == "rgbd" ? 90 : 45);
    EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.004) << sensor;
  }
  EXPECT_EQ(program.run({"map", "info", "rgbd/map.hfm"}).exit_code, 0);
  EXPECT_THAT(program.run({"map", "info", "rgbd/map.hfm"}).output,
              HasSubstr(GetParam().find("fisheye") != std::string::npos ? ", fisheye" : ", distorted"));
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, LensRun,
    testing::Values(
        "fx: 420, fy: 420, lens: fisheye, k1: -0.03, k2: 0.01, k3: -0.02, k4: 0.004",
        "fx: 230, fy: 230, lens: fisheye, k1: 0.0035, k2: 0.0007, k3: -0.002, k4: 0.0002",  // to 100 degrees
        "fx: 420, fy: 420, k1: 0.515, k2: -2.61, p1: 0.0007, p2: -0.0002, k3: 1.505, k4: 0.394, k5: -2.434, "
        "k6: 1.4338"));

}  // namespace
}  // namespace holdfast
