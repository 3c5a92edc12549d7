// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>

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
    program_.write("truth.yaml", configuration("truth: { classes: [person, notice board] }"));
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

TEST_F(SegmentTest, WritesWhatPrecomputedReadsBackAsItWas) {
  const Outcome first = program_.run({"segment", "truth.yaml", "--output", "labels"});
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(first.errors, "");
  EXPECT_THAT(first.output, HasSubstr("3 label images are in labels, for 3 frames"));
  EXPECT_EQ(program_.text("labels/labels.txt"),
            "# label images; classes.yaml says what the values mean\n# timestamp filename\n"
            "0.000000 0.000000.png\n0.100000 0.100000.png\n0.200000 0.200000.png\n");
  const std::string meaning = "labels: { 0: background, 1: notice board, 2: person, 255: unknown }\n";
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
  const Outcome outcome = program_.run({"segment", "truth.yaml", "--output", "labels", "--every", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(fs::exists(program_.path("labels/0.200000.png")));
  EXPECT_EQ(images_in("labels"), 2U);
  EXPECT_THAT(outcome.output, HasSubstr("tolerance: 0.1\n"));
}

TEST_F(SegmentTest, OverwritesOnlyWhatItWrote) {
  ASSERT_EQ(program_.run({"segment", "truth.yaml", "--output", "labels"}).exit_code, 0);
  program_.write("labels/notes.txt", "mine");
  EXPECT_THAT(program_.run({"segment", "truth.yaml", "--output", "labels"}).errors, HasSubstr("is not empty"));
  const std::vector<std::string> again = {
      "segment", "truth.yaml", "--output", "labels", "--overwrite", "--set", "source.simulated.duration=0.1"};
  ASSERT_EQ(program_.run(again).exit_code, 0);
  EXPECT_EQ(images_in("labels"), 1U);
  EXPECT_EQ(program_.text("labels/notes.txt"), "mine");

  fs::create_directory(program_.path("recording"));
  program_.write("recording/1.000000.png", "a picture");
  const Outcome outcome = program_.run({"segment", "truth.yaml", "--output", "recording", "--overwrite"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("no classes.yaml of an earlier run; name another folder"));
  EXPECT_EQ(program_.text("recording/1.000000.png"), "a picture");
}

TEST_F(SegmentTest, SaysWhatIsWrong) {
  program_.write("none.yaml",
                 "source: { simulated: { scene: scene.yaml } }\ncamera: tum_fr1\nfeatures: orb\n"
                 "optimizer: ceres\n");
  const Outcome none = program_.run({"segment", "none.yaml", "--output", "out"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, AllOf(HasSubstr("none.yaml"), HasSubstr("the segmenter is 'none'")));
  program_.write("missing.yaml", configuration("precomputed: { path: nowhere, labels: { 1: person } }"));
  const Outcome missing = program_.run({"segment", "missing.yaml", "--output", "out"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors, HasSubstr("nowhere: is missing; expected a folder of label images"));
  program_.write("overlap.yaml", configuration("precomputed: { path: nowhere, labels: { 1: person, 1-2: chair } }"));
  EXPECT_EQ(program_.run({"segment", "overlap.yaml", "--output", "out"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(program_.path("out")));

  // A value that nobody named: what was done before is kept.
  ASSERT_EQ(program_.run({"segment", "truth.yaml", "--output", "labels", "--quiet"}).exit_code, 0);
  fs::remove(program_.path("labels/0.000000.png"));
  program_.write("unmapped.yaml", configuration("precomputed: { path: labels, labels: { 9: person } }"));
  const Outcome unmapped = program_.run({"segment", "unmapped.yaml", "--output", "kept"});
  EXPECT_EQ(unmapped.exit_code, 1);
  EXPECT_THAT(unmapped.errors, AllOf(HasSubstr("0.100000.png: has the value"), HasSubstr("0 label images are in")));
}

TEST_F(SegmentTest, AnInterruptKeepsWhatIsDone) {
  program_.write("long.yaml", configuration("truth: {}", "duration: 600"));
  const pid_t process = program_.start({"segment", "long.yaml", "--output", "labels"});
  for (int i = 0; i < 2000 && !fs::exists(program_.path("labels/0.033333.png")); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
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
