// SPDX-License-Identifier: BSD-3-Clause
#include "heat_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace holdfast::onnx_features_plugin {
namespace {

/// Smooth hills of different heights.
cv::Mat hills(const std::vector<HeatPoint>& tops) {
  cv::Mat heat(60, 80, CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < heat.rows; ++y)
    for (int x = 0; x < heat.cols; ++x)
      for (const HeatPoint& top : tops) {
        const float dx = static_cast<float>(x) - top.x, dy = static_cast<float>(y) - top.y;
        heat.at<float>(y, x) += top.score * std::exp(-(dx * dx + dy * dy) / 8.0F);
      }
  return heat;
}

TEST(HeatMap, FindsTopsBetweenPixels) {
  const std::vector<HeatPoint> tops{{20.3F, 10.0F, 0.9F}, {40.0F, 30.4F, 0.5F}, {60.0F, 50.0F, 0.7F}};
  const std::vector<HeatPoint> found = keypoints_of(hills(tops), {.threshold = 0.1F});
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i].x, tops[i].x, 0.05F);
    EXPECT_NEAR(found[i].y, tops[i].y, 0.05F);
  }
  const std::vector<HeatPoint> whole = keypoints_of(hills(tops), {.threshold = 0.1F, .subpixel = false});
  EXPECT_EQ(whole[0].x, 20.0F);
}

TEST(HeatMap, HonoursThresholdBorderRadiusAndCount) {
  const std::vector<HeatPoint> tops{{2, 10, 0.9F}, {40, 30, 0.5F}, {46, 30, 0.6F}, {60, 50, 0.7F}};
  EXPECT_EQ(keypoints_of(hills(tops), {.threshold = 0.1F, .border = 1}).size(), 4U);
  EXPECT_EQ(keypoints_of(hills(tops), {.threshold = 0.1F, .border = 5}).size(), 3U);
  EXPECT_EQ(keypoints_of(hills(tops), {.threshold = 0.65F, .border = 5}).size(), 1U);
  const auto apart = keypoints_of(hills(tops), {.threshold = 0.1F, .suppression_radius = 8, .border = 5});
  ASSERT_EQ(apart.size(), 2U) << "of two near tops the higher one";
  EXPECT_NEAR(apart[0].x, 46.0F, 0.5F);
  const auto best = keypoints_of(hills(tops), {.threshold = 0.1F, .border = 1, .count = 2});
  ASSERT_EQ(best.size(), 2U);
  EXPECT_NEAR(best[0].score, 0.9F, 0.05F);
  EXPECT_NEAR(best[1].score, 0.7F, 0.05F);
}

TEST(HeatMap, OfEqualScoresTheFirstIsKept) {
  cv::Mat heat(20, 20, CV_32FC1, cv::Scalar(0));
  heat(cv::Rect(8, 8, 3, 2)) = 0.5F;
  const auto points = keypoints_of(heat, {.threshold = 0.1F, .subpixel = false});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].x, 8.0F);
  EXPECT_EQ(points[0].y, 8.0F);
}

TEST(HeatMap, CellsOfSuperPointBecomePixels) {
  const int shape[] = {1, 65, 3, 4};
  cv::Mat cells(4, shape, CV_32F, cv::Scalar(0));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) cells.ptr<float>(0, 64, row)[column] = 10.0F;  // no keypoint
  cells.ptr<float>(0, 8 * 5 + 2, 1)[3] = 20.0F;  // row 5, column 2 of the cell in row 1, column 3
  const cv::Mat heat = heat_map_of(cells);
  ASSERT_EQ(heat.size(), cv::Size(32, 24));
  EXPECT_NEAR(heat.at<float>(8 + 5, 24 + 2), 1.0F, 1e-3F);
  EXPECT_LT(heat.at<float>(0, 0), 1e-3F);
  double sum = 0.0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) sum += heat.at<float>(8 + y, 24 + x);
  EXPECT_NEAR(sum, 1.0, 1e-3);
}

TEST(HeatMap, OtherShapesAreNone) {
  const int shape[] = {1, 7, 3, 4}, pair[] = {2, 1, 3, 4};
  EXPECT_TRUE(heat_map_of(cv::Mat(4, shape, CV_32F)).empty());
  EXPECT_TRUE(heat_map_of(cv::Mat(4, pair, CV_32F)).empty());
}

}  // namespace
}  // namespace holdfast::onnx_features_plugin
