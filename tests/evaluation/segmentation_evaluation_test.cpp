// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/segmentation_evaluation.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> three = {"background", "person", "chair"};

/// Rows of digits, '?' = unknown.
cv::Mat image_of(const std::vector<std::string>& rows) {
  cv::Mat image(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()), CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const char value = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      image.at<std::uint8_t>(y, x) = value == '?' ? 255 : static_cast<std::uint8_t>(value - '0');
    }
  return image;
}

TEST(SegmentationEvaluation, FiguresOfASmallImageByHand) {
  SegmentationEvaluator evaluator(three);
  evaluator.add(image_of({"0011",  //
                          "0011",  //
                          "022?"}),
                image_of({"0001",  //
                          "0111",  //
                          "0?21"}));
  const SegmentationEvaluation& result = evaluator.result();
  const ClassEvaluation &background = result.classes[0], &person = result.classes[1], &chair = result.classes[2];
  EXPECT_EQ(result.known_pixels, 11U);
  EXPECT_EQ(person.true_pixels, 4U);
  EXPECT_EQ(person.found_pixels, 4U) << "where the truth is unknown nothing counts";
  EXPECT_EQ(person.both, 3U);
  EXPECT_DOUBLE_EQ(person.iou(), 3.0 / 5.0);
  EXPECT_DOUBLE_EQ(person.accuracy(), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(background.iou(), 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(background.accuracy(), 4.0 / 5.0);
  EXPECT_DOUBLE_EQ(chair.iou(), 1.0 / 2.0) << "an unknown prediction is a miss, and a find of nothing";
  EXPECT_DOUBLE_EQ(chair.accuracy(), 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(result.overall_accuracy(), 8.0 / 11.0);
  EXPECT_DOUBLE_EQ(result.mean_iou(), (3.0 / 5.0 + 4.0 / 6.0 + 1.0 / 2.0) / 3.0);
  EXPECT_DOUBLE_EQ(result.mean_accuracy(), (3.0 / 4.0 + 4.0 / 5.0 + 1.0 / 2.0) / 3.0);
  EXPECT_EQ(person.false_pixels(), 1U);
}

TEST(SegmentationEvaluation, ConfidenceIsComparedWithTheShareOfCorrectPixels) {
  SegmentationEvaluator evaluator({"background", "person"});
  cv::Mat confidence(2, 4, CV_8UC1);
  // Row 0: three predictions of 'person' at 0.8, two of them right, and one at 1. Row 1: background, one pixel unknown.
  for (int x = 0; x < 4; ++x) {
    confidence.at<std::uint8_t>(0, x) = x < 3 ? 204 : 255;
    confidence.at<std::uint8_t>(1, x) = 153;
  }
  evaluator.add(image_of({"1101", "000?"}), image_of({"1111", "0000"}), confidence);
  const ClassEvaluation &background = evaluator.result().classes[0], &person = evaluator.result().classes[1];
  ASSERT_EQ(person.confidence_bins.size(), confidence_bin_count);
  const ConfidenceBin &at_80 = person.confidence_bins[204 * confidence_bin_count / 256],
                      &last = person.confidence_bins.back();
  EXPECT_EQ(at_80.pixels, 3U);
  EXPECT_EQ(at_80.correct, 2U);
  EXPECT_NEAR(at_80.confidence, 2.4, 1e-12);
  EXPECT_EQ(last.pixels, 1U);
  EXPECT_NEAR(person.calibration_error(), (2.4 - 2.0) / 4.0, 1e-12);
  EXPECT_NEAR(background.calibration_error(), 0.4, 1e-12) << "the unknown pixel does not count";
  const auto json = nlohmann::json::parse(to_json(evaluator.result()));
  ASSERT_EQ(json["classes"][1]["reliability"].size(), 2U) << "intervals without pixels are left out";
  EXPECT_NEAR(json["classes"][1]["reliability"][0]["correct"], 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(json["classes"][1]["reliability"][0]["confidence"], 0.8, 1e-12);
  EXPECT_THAT(to_text(evaluator.result()), HasSubstr("10.00"));

  EXPECT_THROW(evaluator.add(image_of({"11"}), image_of({"11"}), confidence), CheckError);
  SegmentationEvaluator without({"background", "person"});
  without.add(image_of({"11"}), image_of({"11"}));
  EXPECT_TRUE(std::isnan(without.result().classes[1].calibration_error()));
}

TEST(SegmentationEvaluation, DetectedAboveAHalfImageByImage) {
  SegmentationEvaluator evaluator({"background", "person"});
  const cv::Mat half = image_of({"11", "00"}), most = image_of({"11", "10"}), none = image_of({"00", "00"});
  evaluator.add(half, most);                    // 2 / 3
  evaluator.add(half, none);                    // 0
  evaluator.add(most, image_of({"10", "01"}));  // 1 / 4
  evaluator.add(half, image_of({"10", "00"}));  // 1 / 2: not above
  evaluator.add(none, most);                    // shows nobody
  const ClassEvaluation& person = evaluator.result().classes[1];
  EXPECT_EQ(person.images, 4U);
  EXPECT_EQ(person.detected, 1U);
  EXPECT_DOUBLE_EQ(person.detection_rate(), 0.25);
  EXPECT_DOUBLE_EQ(person.iou(), 4.0 / 14.0) << "pixels of all images together";
}

/// A square of people of the given side in an image of 100 x 100 (outlines 3 pixels wide: 0.02 * 141.4).
cv::Mat square(int left, int top, int side) {
  cv::Mat image = cv::Mat::zeros(100, 100, CV_8UC1);
  image(cv::Rect(left, top, side, side)).setTo(1);
  return image;
}

TEST(SegmentationEvaluation, OutlinesByHand) {
  const auto boundary_iou = [](const cv::Mat& labels, const cv::Mat& predictions) {
    SegmentationEvaluator evaluator({"background", "person"});
    evaluator.add(labels, predictions);
    return evaluator.result().classes[1];
  };
  // An outline of 3 pixels: 20 * 20 - 14 * 14 = 204.
  EXPECT_EQ(boundary_iou(square(10, 10, 20), square(10, 10, 20)).boundary_both, 204U);
  EXPECT_DOUBLE_EQ(boundary_iou(square(10, 10, 20), square(10, 10, 20)).boundary_iou(), 1.0);
  // Smaller by 3 on every side: the rings of 204 and 14 * 14 - 8 * 8 = 132 pixels do not meet, though the IoU is 0.49.
  const ClassEvaluation inside = boundary_iou(square(10, 10, 20), square(13, 13, 14));
  EXPECT_EQ(inside.boundary_both, 0U);
  EXPECT_EQ(inside.boundary_union, 204U + 132U);
  EXPECT_DOUBLE_EQ(inside.iou(), 196.0 / 400.0);
  // The border of the image ends a region, too.
  EXPECT_EQ(boundary_iou(square(0, 0, 100), square(0, 0, 100)).boundary_both, 100U * 100U - 94U * 94U);
  // Nobody anywhere: a figure of nothing.
  EXPECT_TRUE(std::isnan(boundary_iou(square(0, 0, 0), square(0, 0, 0)).boundary_iou()));
}

TEST(SegmentationEvaluation, TableAndJson) {
  SegmentationEvaluator evaluator(three);
  evaluator.add(image_of({"0011"}), image_of({"0111"}));
  const std::string text = to_text(evaluator.result());
  EXPECT_THAT(text, HasSubstr("person                   66.67        100.00        100.00"));
  EXPECT_THAT(text, HasSubstr("chair                        -             -             -"));
  const auto json = nlohmann::json::parse(to_json(evaluator.result()));
  EXPECT_DOUBLE_EQ(json["classes"][1]["iou"], 2.0 / 3.0);
  EXPECT_TRUE(json["classes"][2]["iou"].is_null());
  EXPECT_DOUBLE_EQ(json["mean_iou"], (0.5 + 2.0 / 3.0) / 2.0) << "over the classes that occur";
  EXPECT_DOUBLE_EQ(json["overall_accuracy"], 0.75);
}

TEST(SegmentationEvaluation, WrongImagesAreRefused) {
  SegmentationEvaluator evaluator({"background", "person"});
  EXPECT_THROW(evaluator.add(image_of({"00"}), image_of({"0"})), CheckError);
  EXPECT_THROW(evaluator.add(image_of({"02"}), image_of({"00"})), CheckError);
  EXPECT_THROW(evaluator.add(image_of({"00"}), image_of({"02"})), CheckError);
}

}  // namespace
}  // namespace holdfast
