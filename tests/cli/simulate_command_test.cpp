// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/simulate_command.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;

int run(const std::string& arguments) {
  CLI::App app;
  int exit_code = -1;
  add_simulate_command(app, exit_code);
  app.parse(arguments);
  return exit_code;
}

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(SimulateCommand, WritesASequenceThatCanBeReadAndProtectsIt) {
  const fs::path root = fs::path(testing::TempDir()) / "holdfast_simulate_command_test";
  fs::remove_all(root);
  const fs::path folder = root / "sequence";
  const std::string command = "simulate --path halfsphere --duration 0.1 --seed 4 --camera tum_fr2 --output ";
  ASSERT_EQ(run(command + folder.string()), 0);

  const Trajectory truth = read_trajectory(folder / "groundtruth.txt");
  ASSERT_EQ(truth.size(), 3U);
  std::istringstream associations(content(folder / "associations.txt"));
  double colour_stamp = 0, depth_stamp = 0;
  std::string colour_name, depth_name;
  int frames = 0;
  while (associations >> colour_stamp >> colour_name >> depth_stamp >> depth_name) {
    const cv::Mat colour = cv::imread((folder / colour_name).string(), cv::IMREAD_UNCHANGED);
    const cv::Mat depth = cv::imread((folder / depth_name).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(colour.type(), CV_8UC3);
    ASSERT_EQ(depth.type(), CV_16UC1);
    EXPECT_EQ(colour.size(), cv::Size(640, 480));
    EXPECT_EQ(depth.size(), cv::Size(640, 480));
    const double middle = depth.at<std::uint16_t>(300, 320) / 5000.0;
    EXPECT_TRUE(middle == 0.0 || (middle > 0.4 && middle < 8.0)) << middle;
    EXPECT_NEAR(truth[static_cast<std::size_t>(frames)].timestamp, colour_stamp, 1e-9);
    ++frames;
  }
  EXPECT_EQ(frames, 3);
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    const std::string text = content(folder / list);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << list;  // two comments
  }
  const nlohmann::json scene = nlohmann::json::parse(content(folder / "scene.json"));
  EXPECT_EQ(scene["seed"], 4);
  EXPECT_EQ(scene["camera"]["name"], "tum_fr2");
  EXPECT_GT(scene["objects"].size(), 50U);
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    EXPECT_TRUE(entry.is_directory() || entry.path().extension() != ".tmp") << entry.path();

  EXPECT_THROW(run(command + folder.string()), InputError);
  const std::string before = content(folder / colour_name);
  fs::remove(folder / "rgb.txt");
  ASSERT_EQ(run(command + folder.string() + " --overwrite"), 0);
  EXPECT_TRUE(fs::exists(folder / "rgb.txt"));
  EXPECT_TRUE(content(folder / colour_name) == before);
  fs::remove_all(root);
}

}  // namespace
}  // namespace holdfast
