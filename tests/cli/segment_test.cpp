// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class SegmentTest : public ::testing::Test {
 protected:
  SegmentTest() {
    program_.write("scene.yaml",
                   "room: office\nduration: 0.3\nframe_rate: 10\ncamera: { path: static }\n"
                   "people:\n  - { at: [2.5, 3.0] }\n");
    program_.write("truth.yaml", configuration("truth: { classes: [person, pen holder] }"));
  }
  /// Three tiny images at 0, 0.1 and 0.2 s, and labels of them with a 7 in each.
  void write_recording() const {
    for (const char* folder : {"images", "masks"}) fs::create_directory(program_.path(folder));
    cv::Mat labels(6, 8, CV_8UC1, cv::Scalar(0));
    labels.at<std::uint8_t>(2, 3) = 7;
    for (int i = 0; i < 3; ++i) {
      const std::string number = std::to_string(i);
      cv::imwrite(program_.path("images/" + number + ".png").string(), cv::Mat(6, 8, CV_8UC3, cv::Scalar(9, 9, i)));
      cv::imwrite(program_.path("masks/0." + number + "00000.png").string(), labels);
    }
  }
  /// Of the recording.
  static std::string recorded(const std::string& segmenter) {
    return "source: { folder: { path: ., colour: images, frame_rate: 10 } }\n"
           "camera: { width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5 }\nfeatures: orb\noptimizer: ceres\n" +
           (segmenter.empty() ? "" : "segmenter: { " + segmenter + " }\n");
  }
  static std::string configuration(const std::string& segmenter, const std::string& source = "scene: scene.yaml") {
    return "source: { simulated: { " + source +
           " } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\nsegmenter: { " + segmenter + " }\n";
  }
  std::size_t images_in(const std::string& folder) const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(program_.path(folder))) count += entry.path().extension() == ".png";
    return count;
  }
  test::Program program_;
};

TEST_F(SegmentTest, OneFrameWithItsPicture) {
  const Outcome outcome = program_.run({"segment", "truth.yaml", "--output", "look", "--frames", "1", "--pictures"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(images_in("look"), 1U);
  const cv::Mat picture = cv::imread(program_.path("look/0.000000.jpg").string());
  const cv::Mat labels = cv::imread(program_.path("look/0.000000.png").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.size(), labels.size());
  ASSERT_GT(cv::countNonZero(labels == 1), 100);
  const cv::Scalar people = cv::mean(picture, labels == 1);
  EXPECT_GT(people[2], people[0] + 60.0) << "vermilion on people";
  const Outcome again = program_.run({"segment", "truth.yaml", "--output", "look", "--frames", "2", "--overwrite"});
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_EQ(images_in("look"), 2U);
  EXPECT_FALSE(fs::exists(program_.path("look/0.000000.jpg"))) << "pictures of an earlier run are replaced, too";
}

TEST_F(SegmentTest, WritesWhatPrecomputedReadsBackAsItWas) {
  const Outcome first = program_.run({"segment", "truth.yaml", "--output", "labels"});
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(first.errors, "");
  EXPECT_THAT(first.output, HasSubstr("3 label images are in labels, for 3 frames"));
  EXPECT_EQ(program_.text("labels/labels.txt"),
            "# label images; classes.yaml says what the values mean\n# timestamp filename\n"
            "0.000000 0.000000.png\n0.100000 0.100000.png\n0.200000 0.200000.png\n");
  const std::string meaning = "labels: { 0: background, 1: \"pen holder\", 2: person, 255: unknown }\n";
  EXPECT_EQ(program_.text("labels/classes.yaml"), meaning);
  EXPECT_EQ(std::distance(fs::directory_iterator(program_.path("labels")), {}), 5);  // nothing half-written is left

  // The printed section, as it stands, in place of the segmenter's.
  const std::string section = first.output.substr(first.output.find("segmenter:"));
  EXPECT_THAT(section, HasSubstr("path: " + program_.path("labels").string() + "\n    " + meaning));
  const std::string text = configuration("x: {}");
  program_.write("again.yaml", text.substr(0, text.find("segmenter:")) + section);
  const Outcome second = program_.run({"segment", "again.yaml", "--output", "copy", "--quiet"});
  ASSERT_EQ(second.exit_code, 0) << second.errors;
  EXPECT_EQ(second.output, "");
  for (const char* name : {"0.000000.png", "0.100000.png", "0.200000.png", "labels.txt", "classes.yaml"})
    EXPECT_TRUE(program_.text(std::string("copy/") + name) == program_.text(std::string("labels/") + name)) << name;
}

TEST_F(SegmentTest, EveryNthFrameComesWithATolerance) {
  write_recording();
  program_.write("recorded.yaml", recorded("precomputed: { path: masks, labels: { 7: person } }"));
  const Outcome outcome = program_.run({"segment", "recorded.yaml", "--output", "labels", "--every", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(fs::exists(program_.path("labels/0.200000.png")));
  EXPECT_EQ(images_in("labels"), 2U);
  EXPECT_THAT(outcome.output, HasSubstr("tolerance: 0.1\n"));
}

TEST_F(SegmentTest, OverwritesOnlyWhatItWrote) {
  write_recording();
  program_.write("recorded.yaml", recorded("precomputed: { path: masks, labels: { 7: person } }"));
  const std::vector<std::string> command = {"segment", "recorded.yaml", "--output", "labels"};
  ASSERT_EQ(program_.run(command).exit_code, 0);
  EXPECT_EQ(images_in("labels"), 3U);
  program_.write("labels/notes.txt", "mine");
  EXPECT_THAT(program_.run(command).errors, HasSubstr("is not empty"));
  std::vector<std::string> again = command;
  again.insert(again.end(), {"--overwrite", "--set", "source.folder.frames=1"});
  ASSERT_EQ(program_.run(again).exit_code, 0);
  EXPECT_EQ(images_in("labels"), 1U);
  EXPECT_EQ(program_.text("labels/notes.txt"), "mine");

  const std::string before = program_.text("masks/0.100000.png");
  const Outcome outcome = program_.run({"segment", "recorded.yaml", "--output", "masks", "--overwrite"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("no classes.yaml of an earlier run; name another folder"));
  EXPECT_EQ(program_.text("masks/0.100000.png"), before);
}

TEST_F(SegmentTest, SaysWhatIsWrong) {
  write_recording();
  const auto run = [&](const std::string& segmenter) {
    program_.write("wrong.yaml", recorded(segmenter));
    return program_.run({"segment", "wrong.yaml", "--output", "out"});
  };
  const Outcome none = run("");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, AllOf(HasSubstr("wrong.yaml"), HasSubstr("the segmenter is 'none'")));
  const Outcome missing = run("precomputed: { path: nowhere, labels: { 7: person } }");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors, HasSubstr("nowhere: is missing; expected a folder of label images"));
  EXPECT_EQ(run("precomputed: { path: masks, labels: { 1: person, 1-2: chair } }").exit_code, 2);
  const Outcome truth = run("truth: {}");
  EXPECT_EQ(truth.exit_code, 2);
  EXPECT_THAT(truth.errors, HasSubstr("only a simulation does"));
  EXPECT_FALSE(fs::exists(program_.path("out")));

  // Masks of another recording.
  for (int i = 0; i < 3; ++i) {
    const std::string name = "." + std::to_string(i) + "00000.png";
    fs::rename(program_.path("masks/0" + name), program_.path("masks/500" + name));
  }
  const Outcome other = run("precomputed: { path: masks, labels: { 7: person } }");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.errors, HasSubstr("'precomputed' had nothing for any of 3 frames"));
}

TEST_F(SegmentTest, AFailureKeepsWhatIsDone) {
  write_recording();
  cv::imwrite(program_.path("masks/0.200000.png").string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(9)));
  program_.write("unmapped.yaml", recorded("precomputed: { path: masks, labels: { 7: person } }"));
  const Outcome outcome = program_.run({"segment", "unmapped.yaml", "--output", "kept"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("0.200000.png: has the value 9 at pixel (0, 0)"),
                                    HasSubstr("2 label images are in kept")));
  EXPECT_THAT(program_.text("kept/labels.txt"), HasSubstr("0.100000 0.100000.png\n"));
}

TEST_F(SegmentTest, AnInterruptKeepsWhatIsDone) {
  program_.write("long.yaml", configuration("truth: {}", "duration: 600"));
  const pid_t process = program_.start({"segment", "long.yaml", "--output", "labels"});
  program_.wait_until(process, [&] { return fs::exists(program_.path("labels/0.033333.png")); });
  kill(process, SIGINT);
  const Outcome outcome = program_.finish(process);
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.errors, HasSubstr("interrupted; "));
  const std::string list = program_.text("labels/labels.txt");
  EXPECT_EQ(static_cast<std::size_t>(std::count(list.begin(), list.end(), '\n')), images_in("labels") + 2);
  EXPECT_GE(images_in("labels"), 2U);
}

}  // namespace
}  // namespace holdfast
