// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"

namespace holdfast {
namespace {

nlohmann::json run_stereo(const test::Program& program, const std::string& output,
                          const std::vector<std::string>& settings) {
  std::vector<std::string> arguments{"run", std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/stereo.yaml"};
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  arguments.insert(arguments.end(), {"--output", output, "--quiet"});
  const test::Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  return nlohmann::json::parse(program.text(output + "/run.json"));
}

TEST(StereoRun, DrivesAlongARealStreetAndTwiceTheSame) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with kitti_stereo_51";
  const test::Program program;
  const std::vector<std::string> street{std::string("source.kitti.path=") + data + "/kitti_stereo_51"};
  const nlohmann::json summary = run_stereo(program, "a", street);
  EXPECT_EQ(summary.at("frames").at("poses"), 51);
  EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.050);  // of a path of 60 m; 0.152 without correction
  const nlohmann::json& pair = summary.at("pair_calibration");
  EXPECT_GT(pair.at("shift_px"), 0.03);
  EXPECT_GT(pair.at("shift_sigma_px"), 0.0);
  EXPECT_LT(pair.at("shift_sigma_px"), 0.05);
  run_stereo(program, "b", street);
  EXPECT_EQ(program.text("a/trajectory.txt"), program.text("b/trajectory.txt"));
}

/// The calibration of the recording shifts disparities by 0.2 px: with this shift given, the path has its true length.
TEST(StereoRun, AGivenErrorOfTheCalibrationIsCorrected) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with kitti_stereo_51";
  const test::Program program;
  const nlohmann::json summary = run_stereo(program, "out",
                                            {std::string("source.kitti.path=") + data + "/kitti_stereo_51",
                                             "stereo.self_calibration=fixed", "stereo.column_offset=0.2"});
  EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.050);
  EXPECT_EQ(summary.at("pair_calibration").at("column_offset_px"), 0.2);
}

/// The map is a thousand times too large, and no frame is tracked in it.
TEST(StereoRun, ABaselineInMillimetresIsToldAndTheRunIsNoSuccess) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with kitti_stereo_51";
  const test::Program program;
  const std::filesystem::path street = std::filesystem::path(data) / "kitti_stereo_51";
  for (const char* folder : {"left", "right"})
    std::filesystem::create_directory_symlink(street / folder, program.path(folder));
  program.write("calib.txt",
                "707.0912 0 601.8873 0 0 707.0912 183.1104 0 0 0 1 0\n"
                "707.0912 0 601.8873 -379814.5 0 707.0912 183.1104 0 0 0 1 0\n");
  const std::vector<std::string> arguments{std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/stereo.yaml", "--set",
                                           "source={kitti: {path: " + program.path(".").string() + ", frames: 8}}"};
  const auto outcome_of = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, arguments.begin(), arguments.end());
    return program.run(words);
  };
  const test::Outcome check = outcome_of({"check"}), run = outcome_of({"run", "--output", "out", "--quiet"});
  for (const test::Outcome& outcome : {check, run})
    EXPECT_NE(outcome.errors.find("the baseline is 537.2 m; expected"), std::string::npos) << outcome.errors;
  EXPECT_EQ(check.exit_code, 0);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.errors.find("error: no pose is supported by the map"), std::string::npos) << run.errors;
}

TEST(StereoRun, APairHasADenseMapWhichDoesNotChangeItsPath) {
  const test::Program program;
  const std::vector<std::string> plain{"source={simulated: {path: xyz, duration: 1, stereo_baseline: 0.11, seed: 1}}",
                                       "camera=tum_fr3", "features.orb.count=500"};
  std::vector<std::string> dense = plain;
  dense.emplace_back("dense_map={enabled: true, voxel_size: 0.05, minimum_views: 1}");
  run_stereo(program, "plain", plain);
  run_stereo(program, "dense", dense);
  EXPECT_EQ(program.text("plain/trajectory.txt"), program.text("dense/trajectory.txt"));
  EXPECT_GT(program.text("dense/static_map.ply").size(), 3 * program.text("plain/static_map.ply").size());
}

TEST(StereoRun, ASimulatedPairIsTrackedToAMillimetre) {
  const test::Program program;
  const nlohmann::json summary =
      run_stereo(program, "out",
                 {"source={simulated: {path: xyz, duration: 4, stereo_baseline: 0.11, seed: 1}}", "camera=tum_fr3"});
  EXPECT_EQ(summary.at("frames").at("poses"), 120);
  EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.003);
  // A perfect pair is left as it is.
  EXPECT_EQ(summary.at("pair_calibration").at("rotation_rad"), nlohmann::json({0.0, 0.0, 0.0}));
  EXPECT_EQ(summary.at("pair_calibration").at("column_offset_px"), 0.0);
}

TEST(StereoRun, GivenErrorsOfTheLensAreReported) {
  const test::Program program;
  const nlohmann::json summary =
      run_stereo(program, "out",
                 {"source={simulated: {path: xyz, duration: 0.5, stereo_baseline: 0.11, seed: 1}}", "camera=tum_fr3",
                  "stereo.self_calibration=fixed", "stereo.radial=0.0001", "stereo.decentring=0.0002"});
  EXPECT_EQ(summary.at("pair_calibration").at("radial"), 0.0001);
  EXPECT_EQ(summary.at("pair_calibration").at("decentring"), 0.0002);
}

/// A lorry fills the middle of the view at a constant distance, with more features than the road: the road decides.
/// With 1000 features, few of the road are like those of a view from a metre behind.
TEST(StereoRun, ASimulatedStreetIsDrivenToAFewCentimetres) {
  const test::Program program;
  for (const std::string count : {"1000", "2000"}) {
    const nlohmann::json summary =
        run_stereo(program, count,
                   {"source={simulated: {scene: " + std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) +
                        "/../scenes/street.yaml, duration: 4, stereo_baseline: 0.54, seed: 1}}",
                    "camera=kitti_00", "features.orb.count=" + count});
    EXPECT_EQ(summary.at("frames").at("poses"), 40) << count;
    EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.10) << count;  // of 40 m
  }
}

/// In dense traffic the lorry in front comes to have more matches than the road after half a second.
TEST(StereoRun, ALorryInDenseTrafficDoesNotTakeTheCameraAlong) {
  const test::Program program;
  const nlohmann::json summary =
      run_stereo(program, "out",
                 {"source={simulated: {scene: " + std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) +
                      "/../scenes/motorway.yaml, set: ['road.speed=10'], duration: 2, stereo_baseline: 0.54, seed: 1}}",
                  "camera=kitti_00"});
  EXPECT_EQ(summary.at("frames").at("poses"), 20);
  EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.05);  // of 20 m; 5 m with the lorry
}

TEST(StereoRun, FiltersWorkOnTheDepthOfThePair) {
  // Two people walk through the view of the pair.
  const test::Program program;
  const std::vector<std::string> walkers{
      "source={simulated: {scene: " + std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) +
          "/../scenes/walking_static.yaml, duration: 6, stereo_baseline: 0.11, seed: 1}}",
      "camera=tum_fr3"};
  std::vector<std::string> with_filters = walkers;
  with_filters.insert(with_filters.end(), {"segmenter=truth", "filters=[{semantic_mask: {}}, {multi_view_depth: {}}]",
                                           "tracking.minimum_inliers=15"});
  const auto error = [](const nlohmann::json& summary) {
    return summary.at("evaluation").at("ate_m").at("rmse").get<double>();
  };
  const double without = error(run_stereo(program, "without", walkers));
  EXPECT_LE(error(run_stereo(program, "with", with_filters)), std::min(0.01, without / 3.0)) << "without: " << without;
}

}  // namespace
}  // namespace holdfast
