// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/instance_evaluation.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/segmentation_evaluation.hpp"

namespace holdfast {
namespace {

const std::vector<std::string> three_classes = {"background", "person", "chair"};

/// Rows of digits, each an instance.
InstanceImage image_of(const std::vector<std::string>& rows, std::vector<InstanceImage::Entry> entries) {
  InstanceImage image{cv::Mat(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()), CV_16UC1),
                      std::move(entries)};
  for (int y = 0; y < image.instances.rows; ++y)
    for (int x = 0; x < image.instances.cols; ++x)
      image.instances.at<std::uint16_t>(y, x) =
          static_cast<std::uint16_t>(rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] - '0');
  return image;
}

TEST(InstanceEvaluation, PerfectInstancesInAnotherOrder) {
  InstanceEvaluator evaluator(three_classes);
  evaluator.add(image_of({"1122", "1103"}, {{1}, {1}, {2}}), image_of({"3322", "3301"}, {{2}, {1}, {1}}));
  const InstanceEvaluation result = evaluator.result();
  EXPECT_DOUBLE_EQ(result.mean_ap50(), 1.0);
  EXPECT_DOUBLE_EQ(result.mean_ap(), 1.0);
  EXPECT_DOUBLE_EQ(result.mean_panoptic_quality(), 1.0);
  EXPECT_EQ(result.classes[1].true_instances, 2U);
  EXPECT_TRUE(std::isnan(result.classes[0].ap()));
}

TEST(InstanceEvaluation, FiguresByHand) {
  // The first person: IoU 6/8 = 0.75, the second is missed; one find of score 0.9 is nothing, one of 0.8 the first
  // person.
  InstanceEvaluator evaluator(three_classes);
  evaluator.add(image_of({"11112222", "11110000", "00000000"}, {{1}, {1}}),
                image_of({"22200000", "22200000", "00000011"}, {{1, 0.9F}, {1, 0.8F}}));
  const ClassInstanceEvaluation person = evaluator.result().classes[1];
  EXPECT_EQ(person.matched, 1U);
  // Precision 1/2 up to a recall of 1/2, 0 beyond: 51 of 101 recalls.
  EXPECT_NEAR(person.ap50(), 0.5 * 51 / 101, 1e-12);
  EXPECT_NEAR(person.ap(), 0.6 * 0.5 * 51 / 101, 1e-12) << "0.5 to 0.75 of ten thresholds";
  EXPECT_NEAR(person.panoptic_quality(), 0.75 / (1 + 0.5 * 2), 1e-12);
}

TEST(InstanceEvaluation, ClassesAndUnknownPixelsCount) {
  const InstanceImage truth = image_of({"1100"}, {{1}}), found = image_of({"1111"}, {{1}}),
                      chair = image_of({"1100"}, {{2}});
  const cv::Mat left = (cv::Mat_<std::uint8_t>(1, 4) << 255, 255, 0, 0);
  InstanceEvaluator everywhere(three_classes), masked(three_classes), other(three_classes);
  everywhere.add(truth, found);
  masked.add(truth, found, left);
  other.add(truth, chair);
  EXPECT_EQ(everywhere.result().classes[1].matched, 0U) << "an IoU of 0.5 is no match of panoptic quality";
  EXPECT_DOUBLE_EQ(everywhere.result().classes[1].ap50(), 1.0);
  EXPECT_DOUBLE_EQ(masked.result().classes[1].panoptic_quality(), 1.0);
  EXPECT_DOUBLE_EQ(other.result().mean_panoptic_quality(), 0.0);
  EXPECT_DOUBLE_EQ(other.result().mean_ap(), 0.0) << "the chair is nobody's";
}

TEST(InstanceEvaluation, IsAMemberOfTheJson) {
  InstanceEvaluator evaluator(three_classes);
  evaluator.add(image_of({"10"}, {{1}}), image_of({"10"}, {{1}}));
  const auto json = nlohmann::json::parse(to_json(SegmentationEvaluator(three_classes).result(), evaluator.result()));
  EXPECT_DOUBLE_EQ(json["instances"]["mean_ap"], 1.0);
  EXPECT_EQ(json["instances"]["classes"].size(), 1U);
  EXPECT_FALSE(nlohmann::json::parse(to_json(SegmentationEvaluator(three_classes).result())).contains("instances"));
  EXPECT_THAT(to_text(evaluator.result()), testing::HasSubstr("person                  100.00"));
}

}  // namespace
}  // namespace holdfast
