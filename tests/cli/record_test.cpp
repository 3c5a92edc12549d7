// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class RecordTest : public testing::Test {
 protected:
  /// A run of a source, quiet, into a folder.
  std::vector<std::string> words(const char* command, const char* configuration, const char* output) const {
    return {command, configuration, "--output", output, "--quiet"};
  }
  void run(const std::vector<std::string>& arguments) const {
    const test::Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
  void write_configuration() const {
    program_.write("camera.yaml",
                   "source: { simulated: { duration: 1.5 } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: schur\n");
  }
  std::size_t files_in(const char* folder) const {
    std::filesystem::directory_iterator files(program_.path(folder));
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }

  test::Program program_;
};

TEST_F(RecordTest, ARunOnTheRecordingIsTheRunThatRecorded) {
  write_configuration();
  std::vector<std::string> recording = words("run", "camera.yaml", "out");
  recording.insert(recording.end(), {"--record", "recording"});
  run(recording);
  run(words("run", "recording/recording.yaml", "again"));
  EXPECT_FALSE(program_.text("out/trajectory.txt").empty());
  EXPECT_EQ(program_.text("again/trajectory.txt"), program_.text("out/trajectory.txt"));
  EXPECT_EQ(program_.text("again/map.hfm"), program_.text("out/map.hfm"));
  EXPECT_EQ(files_in("recording/rgb"), 45U) << "no frame is lost";
  EXPECT_EQ(files_in("recording/depth"), 45U);
}

// What cameras give: depth in whole units.
TEST_F(RecordTest, LosesNothingOfADepthInWholeUnits) {
  write_configuration();
  run({"simulate", "--duration", "1.5", "--output", "first", "--quiet"});
  program_.write("first.yaml", "source: { tum: { path: first } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: schur\n");
  run(words("record", "first.yaml", "second"));
  run(words("run", "first.yaml", "out_first"));
  run(words("run", "second/recording.yaml", "out_second"));
  EXPECT_EQ(program_.text("out_second/trajectory.txt"), program_.text("out_first/trajectory.txt"));
  EXPECT_EQ(program_.text("second/rgb.txt"), program_.text("first/rgb.txt"));
  EXPECT_EQ(program_.text("second/depth.txt"), program_.text("first/depth.txt"));
  EXPECT_EQ(program_.text("second/groundtruth.txt"), program_.text("first/groundtruth.txt"));

  // Its folder can be moved.
  std::filesystem::create_directory(program_.path("elsewhere"));
  std::filesystem::rename(program_.path("second"), program_.path("elsewhere/third"));
  run(words("run", "elsewhere/third/recording.yaml", "out_third"));
  EXPECT_EQ(program_.text("out_third/trajectory.txt"), program_.text("out_first/trajectory.txt"));
}

TEST_F(RecordTest, KeepsTheCameraThatTheSourceKnows) {
  for (const char* folder : {"tum_fr1_desk/rgb", "tum_fr1_desk/depth"})
    std::filesystem::create_directories(program_.path(folder));
  for (const char* name : {"/0.png", "/1.png"}) {
    cv::imwrite(program_.path("tum_fr1_desk/rgb").string() + name, cv::Mat(48, 64, CV_8UC3, cv::Scalar(9, 9, 9)));
    cv::imwrite(program_.path("tum_fr1_desk/depth").string() + name, cv::Mat(48, 64, CV_16UC1, cv::Scalar(5000)));
  }
  program_.write("tum_fr1_desk/camera.yaml", "{ width: 64, height: 48, fx: 51.5, fy: 51.5, cx: 32, cy: 24 }\n");
  program_.write("folder.yaml",
                 "source: { folder: { path: tum_fr1_desk, colour: rgb, depth: depth, intrinsics: "
                 "tum_fr1_desk/camera.yaml } }\ncamera: auto\nfeatures: orb\noptimizer: schur\n");
  run(words("record", "folder.yaml", "recording"));
  EXPECT_THAT(program_.text("recording/recording.yaml"), HasSubstr("fx: 51.5"));
}

// Depth images between the colour images, stamps with as many digits as a clock has.
TEST_F(RecordTest, KeepsTheTimesOfColourAndDepth) {
  run({"simulate", "--duration", "1", "--output", "first", "--quiet"});
  std::istringstream pairs(program_.text("first/associations.txt"));
  std::string changed, colour_stamp, colour, depth_stamp, depth;
  for (int i = 0; pairs >> colour_stamp >> colour >> depth_stamp >> depth; ++i) {
    char line[256];
    std::snprintf(line, sizeof(line), "%.9f %s %.9f %s\n", 1305031102.175304123 + i / 30.0, colour.c_str(),
                  1305031102.160407 + i / 30.0, depth.c_str());
    changed += line;
  }
  program_.write("first/associations.txt", changed);
  program_.write("first.yaml",
                 "source: { tum: { path: first, associations: first/associations.txt } }\n"
                 "camera: tum_fr1\nfeatures: orb\noptimizer: schur\nfilters: [multi_view_depth]\n");
  run(words("record", "first.yaml", "second"));
  run(words("run", "first.yaml", "out_first"));
  run(words("run", "second/recording.yaml", "out_second"));
  EXPECT_EQ(program_.text("out_second/trajectory.txt"), program_.text("out_first/trajectory.txt"));
}

TEST_F(RecordTest, StopsAfterTheFramesThatAreWanted) {
  write_configuration();
  const test::Outcome outcome = program_.run({"record", "camera.yaml", "--output", "recording", "--frames", "5"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("5 frames recorded in recording"));
  EXPECT_THAT(outcome.output, HasSubstr("holdfast run recording/recording.yaml"));
  EXPECT_EQ(files_in("recording/rgb"), 5U);
  EXPECT_EQ(program_.run({"check", "recording/recording.yaml"}).exit_code, 0);
}

TEST_F(RecordTest, RefusesWhatItCannotRecord) {
  write_configuration();
  std::filesystem::create_directory(program_.path("full"));
  program_.write("full/notes.txt", "mine");
  test::Outcome outcome = program_.run({"record", "camera.yaml", "--output", "full"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("the output folder is not empty"));
  outcome = program_.run({"record", "camera.yaml", "--output", "out", "--set", "source.simulated.stereo_baseline=0.1"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("the source 'simulated' has no depth"));
  outcome = program_.run({"run", "camera.yaml", "--output", "out", "--record", "./out/"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("--record and --output name the same folder"));
}

}  // namespace
}  // namespace holdfast
