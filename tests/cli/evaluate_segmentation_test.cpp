// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class EvaluateSegmentation : public ::testing::Test {
 protected:
  /// Truth: 7 in the left half. Predictions: 1 (person) in the left quarter, 2 (chair) in the rest of the first image.
  EvaluateSegmentation() {
    for (const char* folder : {"truth", "found"}) fs::create_directory(program_.path(folder));
    cv::Mat truth = cv::Mat::zeros(8, 16, CV_8UC1), found = truth.clone();
    truth.colRange(0, 8).setTo(7);
    found.colRange(0, 4).setTo(1);
    cv::imwrite(program_.path("truth/b.png").string(), truth);
    cv::imwrite(program_.path("found/b.png").string(), found);
    found.colRange(4, 16).setTo(2);
    cv::imwrite(program_.path("truth/a.png").string(), truth);
    cv::imwrite(program_.path("found/a.png").string(), found);
    cv::imwrite(program_.path("truth/unmatched.png").string(), truth);
  }
  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "evaluate-segmentation");
    return program_.run(arguments);
  }
  /// The two folders, and more arguments.
  Outcome compare(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"--labels", "truth", "--predictions", "found"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  test::Program program_;
};

TEST_F(EvaluateSegmentation, ComparesFoldersByNameAndClass) {
  const Outcome outcome =
      compare({"--label-map", "{7: person}", "--prediction-map", "{1: person, 2: chair}", "--json", "figures.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("2 images, 256 pixels"), HasSubstr("person                   50.00")));
  const auto json = nlohmann::json::parse(program_.text("figures.json"));
  EXPECT_EQ(json["classes"].size(), 2U) << "a class that only the predictions know is background";
  EXPECT_DOUBLE_EQ(json["classes"][1]["accuracy"], 0.5);
  EXPECT_DOUBLE_EQ(json["overall_accuracy"], 0.75);
}

TEST_F(EvaluateSegmentation, ScoresInstances) {
  // The value 7 is one person; it was found as 1 and as a part of 2, which lies over the background, too.
  const std::vector<std::string> maps = {"--label-map", "{7: person}", "--prediction-map", "{1-2: person}"};
  std::vector<std::string> with = maps;
  with.insert(with.end(), {"--instances", "--json", "-"});
  const Outcome outcome = compare(with);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto instances = nlohmann::json::parse(outcome.output)["instances"];
  EXPECT_EQ(instances["classes"][0]["true_instances"], 2);
  EXPECT_EQ(instances["classes"][0]["found_instances"], 3);
  EXPECT_EQ(instances["classes"][0]["matched"], 0) << "the IoU of 1 is 0.5, and of 2 a quarter";
  with = maps;
  with.insert(with.end(), {"--json", "-"});
  EXPECT_FALSE(nlohmann::json::parse(compare(with).output).contains("instances"));
}

TEST_F(EvaluateSegmentation, TakesWhatSegmentWrites) {
  program_.write("scene.yaml",
                 "room: office\nduration: 0.3\nframe_rate: 10\ncamera: { path: static }\n"
                 "people:\n  - { at: [2.5, 3.0] }\n");
  program_.write("truth.yaml",
                 "source: { simulated: { scene: scene.yaml } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n"
                 "segmenter: { truth: { classes: [person] } }\n");
  EXPECT_EQ(program_.run({"segment", "truth.yaml", "--output", "labels"}).exit_code, 0);
  const Outcome outcome = run({"--labels", "labels", "--predictions", "labels", "--json", "-"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(json["images"], 3);
  EXPECT_EQ(json["classes"][1]["name"], "person");
  EXPECT_DOUBLE_EQ(json["classes"][1]["iou"], 1.0);
  EXPECT_DOUBLE_EQ(json["classes"][1]["boundary_iou"], 1.0);

  const Outcome by_source = run({"truth.yaml", "--every", "2", "--json", "-"});
  ASSERT_EQ(by_source.exit_code, 0) << by_source.errors;
  EXPECT_EQ(nlohmann::json::parse(by_source.output)["images"], 2);
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(by_source.output)["mean_iou"], 1.0);
  EXPECT_THAT(run({"truth.yaml", "--instances"}).errors, HasSubstr("the segmenter separates no instances"));
  const Outcome separated = run({"truth.yaml", "--set", "segmenter.truth.instances=true", "--json", "-"});
  ASSERT_EQ(separated.exit_code, 0) << separated.errors;
  EXPECT_DOUBLE_EQ(nlohmann::json::parse(separated.output)["instances"]["mean_ap"], 1.0);
}

TEST_F(EvaluateSegmentation, SaysWhatIsMissing) {
  EXPECT_THAT(compare({}).errors,
              AllOf(HasSubstr("has no classes.yaml"), HasSubstr("--label-map '{1-254: person, 255: unknown}'")));
  EXPECT_THAT(compare({"--label-map", "[person]"}).errors, HasSubstr("found a list"));
  EXPECT_THAT(compare({"--label-map", "{7: person}", "--prediction-map", "{1: person}"}).errors,
              HasSubstr("found/a.png: has the value 2"));
  EXPECT_THAT(run({"--labels", "truth", "--label-map", "{7: person}", "--predictions", "absent"}).errors,
              HasSubstr("absent: is missing"));
  EXPECT_THAT(run({"--labels", "truth"}).errors, HasSubstr("nothing to compare"));
  program_.write("names.txt", "# names\na\nc\n");
  EXPECT_THAT(
      compare({"--label-map", "{7: person}", "--prediction-map", "{1-2: person}", "--list", "names.txt"}).errors,
      HasSubstr("names 'c', which has no label image in truth"));
}

}  // namespace
}  // namespace holdfast
