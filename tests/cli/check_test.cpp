// SPDX-License-Identifier: BSD-3-Clause
// `holdfast check` finds what `holdfast run` would find before its first frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <opencv2/imgcodecs.hpp>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class CheckTest : public ::testing::Test {
 protected:
  CheckTest() {
    program_.write("good.yaml",
                   "source: { simulated: { duration: 0.1 } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n");
  }
  /// The answer of `check` with these overrides, which is to be that of `run`.
  Outcome check(const std::vector<std::string>& overrides) const {
    std::vector<std::string> words = {"check", "good.yaml"};
    for (const std::string& text : overrides) words.insert(words.end(), {"--set", text});
    const Outcome checked = program_.run(words);
    words.front() = "run";
    words.insert(words.end(), {"--output", "out", "--quiet"});
    const Outcome run = program_.run(words);
    EXPECT_EQ(checked.exit_code, run.exit_code);
    EXPECT_EQ(checked.errors, run.errors);
    EXPECT_FALSE(std::filesystem::exists(program_.path("out")));
    return checked;
  }

  test::Program program_;
};

TEST_F(CheckTest, FindsWhatTheModulesOfARunMiss) {
  Outcome outcome = check({"source.simulated.scene=nowhere.yaml"});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, AllOf(StartsWith("error: "), HasSubstr("nowhere.yaml")));
  outcome = check({"source.tum.path=nowhere"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("/nowhere: is missing"));
  outcome = check({"segmenter={onnx: {model: nowhere.onnx, classes: [background, person]}}"});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, HasSubstr("nowhere.onnx"));
  outcome = check({"segmenter={python: {file: nowhere.py}}"});
  EXPECT_NE(outcome.exit_code, 0);
}

TEST_F(CheckTest, SaysWhatIsUnderstoodOfANetwork) {
  const Outcome outcome =
      program_.run({"check", "good.yaml", "--set",
                    "segmenter={onnx: {model: " HOLDFAST_SOURCE_FOLDER "/tests/inference/models/yolov8n-seg.onnx}}",
                    "--set", "filters=[semantic_mask]"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(StartsWith("onnx: yolov8n-seg.onnx is a network of the family yolo"), HasSubstr("movable: person"),
                    HasSubstr("\nok good.yaml: simulated -> orb -> onnx")));
}

TEST_F(CheckTest, CameraAutoAsksTheSource) {
  const auto write_images = [&](const std::string& folder) {
    std::filesystem::create_directories(program_.path(folder));
    for (const char* name : {"/000000.png", "/000001.png"})
      cv::imwrite(program_.path(folder + name).string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)));
  };
  // Its own calibration precedes that of the known camera that the folder is named after.
  for (const std::string folder : {"street", "kitti_00_street"}) {
    write_images(folder + "/image_0"), write_images(folder + "/image_1");
    program_.write(folder + "/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 0\nP1: 50 0 32 -25 0 50 24 0 0 0 1 0\n");
    const Outcome outcome =
        program_.run({"check", "good.yaml", "--set", "source.kitti.path=" + folder, "--set", "camera=auto"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(outcome.output, "ok good.yaml: kitti -> orb -> ceres\n");
  }
  // A folder of images knows its camera only if a calibration is named.
  program_.write("good.yaml",
                 "source: { folder: { path: street, colour: image_0 } }\nsensor: mono\ncamera: auto\nfeatures: orb\n"
                 "optimizer: ceres\n");
  const Outcome outcome = check({});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("good.yaml:3:9: found 'auto' for 'camera', but the source 'folder' does"),
                                    HasSubstr("the name of the folder 'street' says none")));
}

TEST_F(CheckTest, LooksAtTheConfigurationAloneWhenAsked) {
  const Outcome outcome = program_.run({"check", "good.yaml", "--set", "source.tum.path=nowhere", "--without-data"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.output, "ok good.yaml: tum -> orb -> ceres\n");
}

TEST_F(CheckTest, WritesNothing) {
  const auto count = [&] { return std::distance(std::filesystem::directory_iterator(program_.path("")), {}); };
  program_.run({"check", "good.yaml", "--set", "observers=[overlay, objects]"});  // begins stdout and stderr
  const auto before = count();
  EXPECT_EQ(program_.run({"check", "good.yaml", "--set", "observers=[overlay, objects]"}).exit_code, 0);
  EXPECT_EQ(count(), before);
}

/// The program without the library beside it that holds the segmenter `python`.
TEST_F(CheckTest, KnowsThatASegmenterIsNotInThisBuild) {
  std::filesystem::create_directories(program_.path("elsewhere/bin"));
  std::filesystem::copy_file(HOLDFAST_PROGRAM, program_.path("elsewhere/bin/holdfast"));
  const auto run = [&](const std::string& arguments) {
    const std::string line =
        "cd '" + program_.path("").string() + "' && elsewhere/bin/holdfast " + arguments + " > answer 2>&1";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  EXPECT_EQ(run("check good.yaml --without-data --set 'segmenter={python: {file: mine.py}}'"), 2);
  EXPECT_THAT(program_.text("answer"),
              AllOf(HasSubstr("the segmenter module 'python' cannot be used"), HasSubstr("-DHOLDFAST_PYTHON=ON")));
  EXPECT_EQ(run("modules"), 0);
  EXPECT_THAT(program_.text("answer"), AllOf(HasSubstr("\n  python              [not in this build] A segmenter"),
                                             HasSubstr("\n  unet                Segments")));
}

TEST_F(CheckTest, ReadsStandardInput) {
  const auto run = [&](const std::string& arguments) {
    const std::string line = "cd '" + program_.path("").string() + "' && cat good.yaml | '" HOLDFAST_PROGRAM "' " +
                             arguments + " > answer 2>&1";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  EXPECT_EQ(run("check -"), 0);
  EXPECT_EQ(program_.text("answer"), "ok /dev/stdin: simulated -> orb -> ceres\n");
  // Paths in it count from the current folder.
  EXPECT_EQ(run("check - --set features.orb.count=1"), 2);
  EXPECT_EQ(run("run - --output out --quiet"), 0) << program_.text("answer");
  program_.write("good.yaml", "source: { tum: { path: rec } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n");
  EXPECT_EQ(run("check -"), 1);
  EXPECT_THAT(program_.text("answer"), HasSubstr(program_.path("rec").string() + ": is missing"));
}

TEST_F(CheckTest, RefusesANamedPipe) {
  ASSERT_EQ(mkfifo(program_.path("pipe").c_str(), 0600), 0);
  const Outcome outcome = program_.run({"check", "pipe"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.errors, "error: pipe: found a named pipe, which may never end; expected a configuration in YAML\n");
}

TEST_F(CheckTest, RefusesWhatIsNoFileInARecording) {
  namespace fs = std::filesystem;
  for (const char* folder : {"rec", "rec/mav0/cam0/data", "sequence/image_0"})
    fs::create_directories(program_.path(folder));
  program_.write("rec/rgb.txt", "1.0 a.png\n");
  program_.write("rec/depth.txt", "1.0 a.png\n");
  program_.write("rec.yaml", "source: { tum: { path: rec } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n");
  for (const char* name : {"rgb.txt", "depth.txt", "groundtruth.txt", "shutter.txt"}) {
    const fs::path file = program_.path(std::string("rec/") + name), kept = program_.path("kept");
    if (fs::exists(file)) fs::rename(file, kept);
    fs::create_symlink("/dev/zero", file);
    EXPECT_THAT(program_.run({"check", "rec.yaml"}).errors, HasSubstr(std::string(name) + ": found a device"));
    fs::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    EXPECT_THAT(program_.run({"check", "rec.yaml"}).errors, HasSubstr(std::string(name) + ": found a named pipe"));
    fs::remove(file);
    if (fs::exists(kept)) fs::rename(kept, file);
  }
  program_.write("euroc.yaml", "source: { euroc: { path: rec } }\nfeatures: orb\noptimizer: ceres\n");
  fs::create_symlink("/dev/zero", program_.path("rec/mav0/cam0/sensor.yaml"));
  EXPECT_THAT(program_.run({"check", "euroc.yaml"}).errors, HasSubstr("sensor.yaml: found a device"));
  program_.write("kitti.yaml", "source: { kitti: { path: sequence } }\nfeatures: orb\noptimizer: ceres\n");
  cv::imwrite(program_.path("sequence/image_0/000000.png").string(), cv::Mat::zeros(48, 64, CV_8UC1));
  ASSERT_EQ(mkfifo(program_.path("sequence/calib.txt").c_str(), 0600), 0);
  EXPECT_THAT(program_.run({"check", "kitti.yaml"}).errors, HasSubstr("calib.txt: found a named pipe"));
}

TEST_F(CheckTest, TheDemoIsBuiltWithPython) {
  const std::string demo = test::content(HOLDFAST_SOURCE_FOLDER "/cmake/demo.sh");
  EXPECT_THAT(demo, AllOf(HasSubstr("install_dependencies.sh --python"), HasSubstr("-DHOLDFAST_PYTHON=ON")));
}

}  // namespace
}  // namespace holdfast
