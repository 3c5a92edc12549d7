// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_features.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "features/test_images.hpp"
#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::onnx_features_plugin {
namespace {

OnnxFeaturesSettings gradients(int width, int height) {
  OnnxFeaturesSettings settings;
  settings.model = HOLDFAST_MODELS "/gradients.onnx";
  settings.width = width, settings.height = height;
  settings.threshold = 0.02;
  return settings;
}

Features extract(const OnnxFeaturesSettings& settings, const cv::Mat& image, const cv::Mat& ignore = {}) {
  Features features;
  OnnxFeatures(settings).extract(image, ignore, features);
  return features;
}

std::string message_of(const OnnxFeaturesSettings& settings) {
  try {
    OnnxFeatures{settings};
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Share of the features of an image that are nearest to the same feature in the image moved by (6, 4) pixels.
TEST(OnnxFeatures, FindsAndDescribesTheSamePointsInAMovedImage) {
  const cv::Mat image = test::scene_image(330, 250, 3);
  const Features a = extract(gradients(320, 240), image(cv::Rect(0, 0, 320, 240)));
  const Features b = extract(gradients(320, 240), image(cv::Rect(6, 4, 320, 240)));
  ASSERT_GT(a.size(), 100U);
  EXPECT_EQ(a.descriptors.type().length, 128U);
  const DescriptorView of_a = a.descriptors, of_b = b.descriptors;
  const DescriptorDistances distances(of_a.type());
  int judged = 0, right = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float x = a.x[i] - 6.0F, y = a.y[i] - 4.0F;
    if (x < 20.0F || y < 20.0F || x > 300.0F || y > 220.0F) continue;
    std::size_t best = 0;
    for (std::size_t k = 1; k < b.size(); ++k)
      if (distances.of_two(of_a.row(i), of_b.row(k)) < distances.of_two(of_a.row(i), of_b.row(best))) best = k;
    ++judged;
    right += std::hypot(b.x[best] - x, b.y[best] - y) < 1.0F ? 1 : 0;
  }
  EXPECT_GT(judged, 50);
  EXPECT_GT(right, judged * 8 / 10);
}

TEST(OnnxFeatures, AnImageOfAnotherSizeGivesPixelsOfThatImage) {
  const cv::Mat image = test::scene_image(640, 480, 4);
  const Features features = extract(gradients(320, 240), image);
  ASSERT_GT(features.size(), 50U);
  EXPECT_GT(*std::max_element(features.x.begin(), features.x.end()), 400.0F);
  EXPECT_LT(*std::max_element(features.y.begin(), features.y.end()), 480.0F);
}

TEST(OnnxFeatures, EuclideanDescriptorsKeepTheirLength) {
  OnnxFeaturesSettings settings = gradients(320, 240);
  settings.metric = NumberMetric::euclidean;
  Features features = extract(settings, test::scene_image(320, 240, 5));
  ASSERT_FALSE(features.empty());
  double squares = 0.0;
  for (const float number : features.descriptors.numbers(0)) squares += number * number;
  EXPECT_LT(std::abs(squares), 0.9) << "was brought to unit length";
}

TEST(OnnxFeatures, WhatDoesNotFitIsNamed) {
  OnnxFeaturesSettings settings = gradients(320, 240);
  settings.model = HOLDFAST_MODELS "/none.onnx";
  EXPECT_NE(message_of(settings).find("none.onnx"), std::string::npos);
  settings = gradients(0, 240);
  EXPECT_NE(message_of(settings).find("set `width`"), std::string::npos) << message_of(settings);
  settings = gradients(320, 240);
  settings.scores = "score";
  EXPECT_NE(message_of(settings).find("'scores'"), std::string::npos) << message_of(settings);
  settings = gradients(320, 240);
  settings.descriptors = "scores";
  EXPECT_EQ(message_of(settings), "") << "one number per feature is little, and possible";
  settings.keypoints = "points";
  EXPECT_NE(message_of(settings), "");
}

TEST(OnnxFeatures, ScoresThatAreNoMapAreRefused) {
  OnnxFeaturesSettings settings = gradients(320, 240);
  settings.scores = "descriptors";
  Features features;
  OnnxFeatures extractor(settings);
  EXPECT_THROW(extractor.extract(test::scene_image(320, 240, 6), {}, features), InputError);
}

}  // namespace
}  // namespace holdfast::onnx_features_plugin
