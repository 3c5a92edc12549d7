// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_matcher.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "assignment.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::onnx_matcher_plugin {
namespace {

constexpr DescriptorType numbers{DescriptorKind::float32, DescriptorMetric::cosine, 128, 0.2F, 0.4F};

OnnxMatcherSettings correlation() {
  OnnxMatcherSettings settings;
  settings.model = HOLDFAST_MODELS "/correlation.onnx";
  settings.dual_softmax = true;
  settings.temperature = 0.02;
  return settings;
}

/// Features with drawn descriptors; those of `visit` differ from each other's by a little noise.
Frame drawn_frame(std::size_t count, std::uint64_t visit) {
  Random of_feature(3), of_visit(100 + visit);
  Frame frame;
  frame.camera = std::make_shared<Camera>();
  frame.pyramid = std::make_shared<ScalePyramid>(1, 2.0);
  frame.features.resize(count, numbers);
  for (std::size_t i = 0; i < count; ++i) {
    frame.x.push_back(static_cast<float>(of_feature.uniform(0, 600) + of_visit.uniform(0, 5)));
    frame.y.push_back(static_cast<float>(of_feature.uniform(0, 470) + of_visit.uniform(0, 5)));
    frame.features.response[i] = static_cast<float>(i % 7);
    double squares = 0.0;
    for (float& number : frame.features.descriptors.numbers(i)) {
      number = static_cast<float>(of_feature.normal() + 0.3 * of_visit.normal());
      squares += number * number;
    }
    for (float& number : frame.features.descriptors.numbers(i)) number /= static_cast<float>(std::sqrt(squares));
  }
  return frame;
}

std::vector<std::uint32_t> every(std::uint32_t step, const Frame& frame) {
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < frame.size(); i += step) some.push_back(i);
  return some;
}

TEST(OnnxMatcher, FindsFeaturesAgain) {
  const OnnxMatcher matcher(correlation());
  const Frame a = drawn_frame(500, 1), b = drawn_frame(400, 2);
  const auto in_a = every(1, a), in_b = every(2, b);
  std::vector<FeatureMatch> matches;
  matcher.match(side_of(a, in_a), side_of(b, in_b), {}, matches);
  EXPECT_GT(matches.size(), 190U);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    EXPECT_EQ(matches[i].source, matches[i].feature);
    EXPECT_EQ(matches[i].feature % 2, 0U);
    EXPECT_LT(matches[i].distance, 0.4F);
    if (i > 0) {
      EXPECT_LT(matches[i - 1].feature, matches[i].feature);
    }
  }
}

TEST(OnnxMatcher, TakesTheStrongestOfMoreFeaturesThanFit) {
  const OnnxMatcher matcher(correlation());
  const Frame a = drawn_frame(900, 1), b = drawn_frame(900, 2);
  const auto all = every(1, a);
  std::vector<FeatureMatch> matches;
  matcher.match(side_of(a, all), side_of(b, all), {}, matches);
  EXPECT_GT(matches.size(), 500U);
  EXPECT_LE(matches.size(), 600U);
  for (const FeatureMatch& match : matches) EXPECT_GE(a.features.response[match.source], 2.0F);
}

TEST(OnnxMatcher, PointsOfAMapAreMatchedByDistance) {
  const OnnxMatcher matcher(correlation());
  const Frame a = drawn_frame(100, 1), b = drawn_frame(100, 2);
  const auto all = every(1, a);
  std::vector<FeatureMatch> own, nearest;
  const MatchSide points{.descriptors = b.features.descriptors, .selection = all};
  matcher.match(side_of(a, all), points, {.max_distance = 0.4F}, own);
  NearestMatcher().match(side_of(a, all), points, {.max_distance = 0.4F}, nearest);
  EXPECT_EQ(own.size(), nearest.size());
  EXPECT_GT(own.size(), 90U);
}

TEST(OnnxMatcher, WhatDoesNotFitIsNamed) {
  const auto message = [](const OnnxMatcherSettings& settings) -> std::string {
    try {
      OnnxMatcher{settings};
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  OnnxMatcherSettings settings = correlation();
  settings.keypoints1 = "keypoint1";
  EXPECT_NE(message(settings).find("'keypoints1'"), std::string::npos) << message(settings);
  settings = correlation();
  settings.count = 500;
  EXPECT_NE(message(settings).find("`count`"), std::string::npos) << message(settings);
  settings = correlation();
  settings.keypoints0 = "descriptors0";
  EXPECT_NE(message(settings).find("1 x count x 2"), std::string::npos) << message(settings);

  const OnnxMatcher matcher(correlation());
  Frame bits = drawn_frame(10, 1);
  bits.features.descriptors.reset(DescriptorType(), 10);
  const auto all = every(1, bits);
  std::vector<FeatureMatch> matches;
  EXPECT_NE(matcher.incompatibility(DescriptorType()).find("float32"), std::string::npos);
  EXPECT_EQ(matcher.incompatibility(drawn_frame(1, 1).features.descriptors.type()), "");
  EXPECT_THROW(matcher.match(side_of(bits, all), side_of(bits, all), {}, matches), InputError);
}

TEST(Assignment, DualSoftmaxPrefersWhatBothSidesPrefer) {
  cv::Mat scores = (cv::Mat_<float>(2, 3) << 5, 1, 0, 4.9, 0, 3);
  dual_softmax(scores);
  double sum = 0.0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) sum += scores.at<float>(y, x);
  EXPECT_LE(sum, 2.0);
  // By hand: softmax over the row times softmax over the column.
  const double row = std::exp(5.0) / (std::exp(5.0) + std::exp(1.0) + 1.0);
  const double column = std::exp(5.0) / (std::exp(5.0) + std::exp(4.9));
  EXPECT_NEAR(scores.at<float>(0, 0), row * column, 1e-5);
}

TEST(Assignment, OnlyMutualBestsAboveTheThreshold) {
  const cv::Mat probabilities = (cv::Mat_<float>(3, 3) << 0.9, 0.2, 0.0, 0.8, 0.1, 0.0, 0.0, 0.05, 0.04);
  const auto all = mutual_best(probabilities, 0.1F);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].row, 0U);
  EXPECT_EQ(all[0].column, 0U);
  EXPECT_TRUE(mutual_best(cv::Mat(0, 3, CV_32FC1), 0.0F).empty());
  EXPECT_TRUE(mutual_best(cv::Mat(3, 0, CV_32FC1), 0.0F).empty());
}

}  // namespace
}  // namespace holdfast::onnx_matcher_plugin
