// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_command.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "cli/command.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "holdfast/surface/mesh_files.hpp"

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

/// A folder of its own that goes with the object, with a scene of somebody who carries a box.
class SimulateScene : public testing::Test {
 protected:
  SimulateScene()
      : root_(fs::path(testing::TempDir()) /
              (std::string("holdfast_simulate_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(root_);
    fs::create_directories(root_);
    std::ofstream(scene()) << R"(room: office
camera: { path: static }
duration: 2
frame_rate: 1
people:
  - name: Anna
    at: [1.8, 3.0]
    start: -8
    do:
      - carry: { thing: box 3, to: [[2.3, 3.05], [3.6, 3.05]], put_at: [4.7, 3.1, 0.0], speed: 0.6 }
)"
                           << "# by Ren\xe9, in Latin-1, which scene.json holds as UTF-8\n";
  }
  ~SimulateScene() override { fs::remove_all(root_); }

  fs::path scene() const { return root_ / "scene.yaml"; }
  std::string command(const std::string& options) const {
    return "simulate " + scene().string() + " --quiet " + options;
  }

  fs::path root_;
};

/// The number of files that a list names; all of them must exist.
int existing_files(const fs::path& folder, const char* list) {
  std::istringstream lines(content(folder / list));
  std::string line;
  int names = 0;
  while (std::getline(lines, line)) {
    if (line[0] == '#') continue;
    ++names;
    EXPECT_TRUE(fs::exists(folder / line.substr(line.find(' ') + 1))) << line;
  }
  return names;
}

TEST_F(SimulateScene, WritesMasksLabelsAndObjectsThatAgree) {
  const fs::path folder = root_ / "out";
  ASSERT_EQ(run(command("--camera tum_fr3 --output " + folder.string())), 0);
  const nlohmann::json objects = nlohmann::json::parse(content(folder / "objects.json")),
                       about = nlohmann::json::parse(content(folder / "scene.json"));
  EXPECT_EQ(objects["columns"],
            nlohmann::json({"timestamp", "x", "y", "z", "qx", "qy", "qz", "qw", "moving", "pixels"}));
  EXPECT_EQ(about["scene"], "scene");
  EXPECT_EQ(about["room"], "office");
  EXPECT_EQ(about["path"], "static");
  EXPECT_EQ(about["frames"], 2);
  EXPECT_EQ(about["seed"], 1);
  ASSERT_EQ(objects["objects"].size(), 2U);

  simulation::Scene plan = simulation::read_scene(scene(), {"seed=1"});
  simulation::Simulator simulator(plan, *find_camera("tum_fr3"));
  const SensorFrame frames[] = {simulator.frame(0), simulator.frame(1)};
  int seen = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const nlohmann::json& entry = objects["objects"][k];
    const simulation::Object& object = simulator.object(simulator.numbered_objects()[k]);
    EXPECT_EQ(entry["number"], k + 1);
    EXPECT_EQ(entry["name"], k == 0 ? "Anna" : "box 3");
    EXPECT_EQ(entry["class"], k == 0 ? "person" : "box");
    EXPECT_EQ(about["classes"][entry["label"].get<std::size_t>()], entry["class"]);
    ASSERT_EQ(entry["rows"].size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::vector<double> row = entry["rows"][i];
      ASSERT_EQ(row.size(), objects["columns"].size());
      const double time = simulator.timestamp(i);
      EXPECT_NEAR(row[0], time, 1e-6);
      const Eigen::Isometry3d pose = object.pose(time);
      EXPECT_LT((pose.translation() - Eigen::Vector3d(row[1], row[2], row[3])).norm(), 2e-6);
      EXPECT_LT(Eigen::Quaterniond(row[7], row[4], row[5], row[6]).angularDistance(Eigen::Quaterniond(pose.linear())),
                1e-6);
      const FrameTruth& truth = *frames[i].truth;
      const auto& moving = truth.moving_objects;
      EXPECT_EQ(row[8], std::count(moving.begin(), moving.end(), k + 1)) << object.name << ' ' << time;

      const std::string png = i == 0 ? "0.000000.png" : "1.000000.png";
      const cv::Mat mask = cv::imread((folder / "mask" / png).string(), cv::IMREAD_UNCHANGED),
                    labels = cv::imread((folder / "labels" / png).string(), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(mask.type(), CV_8UC1);
      ASSERT_EQ(labels.type(), CV_8UC1);
      ASSERT_EQ(mask.size(), cv::Size(640, 480));
      EXPECT_EQ(cv::norm(mask, truth.object_mask, cv::NORM_INF), 0.0);
      EXPECT_EQ(cv::norm(labels, truth.class_labels, cv::NORM_INF), 0.0);
      const cv::Mat own = mask == static_cast<int>(k + 1);
      EXPECT_EQ(row[9], cv::countNonZero(own)) << object.name << ' ' << time;
      EXPECT_EQ(cv::countNonZero(own & (labels != entry["label"].get<int>())), 0) << object.name << ' ' << time;
      seen += cv::countNonZero(own);
    }
  }
  EXPECT_GT(seen, 1000);
  for (const char* list : {"mask.txt", "labels.txt"}) EXPECT_EQ(existing_files(folder, list), 2) << list;
}

TEST_F(SimulateScene, SameSeedSameBytesInEveryFile) {
  const std::string short_one = "--duration 1 --camera tum_fr3 --set depth_sensor.noise=0.5 --output ";
  for (const char* name : {"a", "b"}) ASSERT_EQ(run(command("--seed 7 " + short_one + (root_ / name).string())), 0);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root_ / "a")) {
    if (entry.is_directory()) continue;
    ++files;
    const fs::path name = fs::relative(entry.path(), root_ / "a");
    EXPECT_TRUE(content(entry.path()) == content(root_ / "b" / name)) << name;
  }
  EXPECT_EQ(files, 13);  // four images, four lists of them, associations, poses, objects, scene, shutter
  const nlohmann::json about = nlohmann::json::parse(content(root_ / "a" / "scene.json"));
  EXPECT_EQ(about["seed"], 7);
  EXPECT_EQ(about["depth_sensor"]["noise"], 0.5);
}

TEST_F(SimulateScene, DrawsAPreviewAndNothingElse) {
  const fs::path picture = root_ / "preview.png";
  ASSERT_EQ(run(command("--camera tum_fr3 --set camera.path=rpy --preview " + picture.string())), 0);
  const cv::Mat preview = cv::imread(picture.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(preview.type(), CV_8UC3);
  EXPECT_GT(preview.cols, 600);
  EXPECT_GT(preview.rows, 400);
  cv::Scalar mean, deviation;
  cv::meanStdDev(preview, mean, deviation);
  EXPECT_GT(deviation[0], 10.0);
  EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 2);  // the scene and the picture
}

TEST_F(SimulateScene, WritesTheTrueSurfaceWhichEvaluateSurfaceCompares) {
  const std::string all = (root_ / "all.ply").string(), seen = (root_ / "seen.ply").string();
  ASSERT_EQ(run(command("--set duration=0.04 --surface " + all + " --seen-surface " + seen)), 0);
  const TriangleMesh room = read_mesh(all), part = read_mesh(seen);
  Eigen::AlignedBox3f box;
  for (const MeshVertex& vertex : room.vertices) box.extend(vertex.position);
  // The office, and what is behind its door.
  EXPECT_TRUE(box.contains(Eigen::Vector3f(0.001F, 0.001F, 0.001F)));
  EXPECT_TRUE(box.contains(Eigen::Vector3f(5.999F, 4.999F, 2.599F)));
  EXPECT_LT(box.sizes().maxCoeff(), 7.0F);
  EXPECT_GT(part.area(), 1.0);
  EXPECT_LT(part.area(), 0.2 * room.area());

  const auto figures = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "evaluate-surface");
    for (const char* word : {"--json", "-", "--spacing", "0.05"}) words.emplace_back(word);
    const test::CommandOutcome outcome = test::run_command(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return nlohmann::json::parse(outcome.output);
  };
  const nlohmann::json whole = figures({all, seen});
  EXPECT_LT(whole["accuracy"], 1e-4);
  EXPECT_EQ(whole["ghosts"], 0.0);
  EXPECT_LT(whole["completion_ratio"], 0.5);
  EXPECT_EQ(figures({all, seen, "--seen", seen})["completion_ratio"], 1.0);

  // The same part in another world frame, with the trajectories of both.
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(1.0, -2.0, 0.5) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, -1).normalized());
  TriangleMesh moved = part;
  for (MeshVertex& vertex : moved.vertices) vertex.position = motion.cast<float>() * vertex.position;
  write_mesh(root_ / "moved.ply", moved);
  Trajectory truth, estimate;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Isometry3d pose =
        Eigen::Translation3d(0.1 * i, 0.0, 1.0) * Eigen::AngleAxisd(0.3 * i, Eigen::Vector3d::UnitZ());
    truth.push_back({0.1 * i, pose});
    estimate.push_back({0.1 * i + 0.001, motion * pose});
  }
  write_trajectory(root_ / "truth.txt", truth);
  write_trajectory(root_ / "estimate.txt", estimate);
  const std::string other = (root_ / "moved.ply").string();
  EXPECT_LT(figures({all, other, "--truth-trajectory", (root_ / "truth.txt").string(), "--trajectory",
                     (root_ / "estimate.txt").string()})["accuracy"],
            1e-4);

  const test::CommandOutcome half = test::run_command({"evaluate-surface", all, seen, "--trajectory", "x.txt"});
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_NE(half.errors.find("--truth-trajectory and --trajectory belong together"), std::string::npos) << half.errors;
  const test::CommandOutcome scene_as_mesh = test::run_command({"evaluate-surface", scene().string(), seen});
  EXPECT_EQ(scene_as_mesh.exit_code, 1);
  EXPECT_NE(scene_as_mesh.errors.find("scene.yaml: is no PLY file"), std::string::npos) << scene_as_mesh.errors;
}

TEST_F(SimulateScene, TellsWhereTheSceneIsWrongAndWritesNothing) {
  const auto problem = [&](const std::string& options) -> std::string {
    try {
      run(command(options + " --output " + (root_ / "out").string()));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem("--set people.0.nmae=Bob").substr(0, 26), "--set people.0.nmae=Bob: a");
  EXPECT_NE(
      problem("--set \"people.0.do.0.carry.thing=box 77\"").find("scene.yaml: people.0.do.0: Anna wants to carry"),
      std::string::npos);
  std::ofstream(scene(), std::ios::app) << "  - { at: [2, 2], nmae: Bob }\n";
  EXPECT_EQ(problem(""), scene().string() + ":12:19: a person has no parameter 'nmae'; did you mean 'name'?");
  EXPECT_FALSE(fs::exists(root_ / "out"));
}

}  // namespace
}  // namespace holdfast
