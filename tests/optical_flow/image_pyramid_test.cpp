// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/optical_flow/image_pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

cv::Mat noise(int width, int height, int type = CV_8UC1) {
  Random random(1);
  cv::Mat image(height, width, type);
  for (int row = 0; row < height; ++row)
    for (std::size_t i = 0; i < static_cast<std::size_t>(width) * image.elemSize(); ++i)
      image.ptr(row)[i] = static_cast<std::uint8_t>(random.below(256));
  return image;
}

TEST(ImagePyramidTest, EachPixelOfTheFirstLevelIsTheMeanOfFour) {
  const cv::Mat image = noise(101, 67);
  ImagePyramid pyramid;
  pyramid.build(image);
  EXPECT_EQ(pyramid.size(), cv::Size(101, 67));
  const cv::Mat& half = pyramid.level(0);
  ASSERT_EQ(half.size(), cv::Size(50, 33));
  for (int row = 0; row < half.rows; ++row)
    for (int column = 0; column < half.cols; ++column) {
      const cv::Scalar mean = cv::mean(image(cv::Rect(2 * column, 2 * row, 2, 2)));
      ASSERT_NEAR(half.at<std::uint8_t>(row, column), mean[0], 0.51) << column << " " << row;
    }
}

TEST(ImagePyramidTest, EachFurtherLevelIsEverySecondPixel) {
  // A ramp is the same ramp when it is smoothed, away from the border.
  cv::Mat ramp(160, 240, CV_8UC1);
  for (int row = 0; row < ramp.rows; ++row)
    for (int column = 0; column < ramp.cols; ++column)
      ramp.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((column + row) / 2);
  ImagePyramid pyramid;
  pyramid.build(ramp);
  for (int level = 1; level < ImagePyramid::levels; ++level) {
    const cv::Mat &now = pyramid.level(level), &before = pyramid.level(level - 1);
    ASSERT_EQ(now.size(), cv::Size((before.cols + 1) / 2, (before.rows + 1) / 2));
    for (int row = 2; row < now.rows - 2; ++row)
      for (int column = 2; column < now.cols - 2; ++column)
        ASSERT_NEAR(now.at<std::uint8_t>(row, column), before.at<std::uint8_t>(2 * row, 2 * column), 1.0) << level;
  }
}

TEST(ImagePyramidTest, TheBorderRepeatsTheOutermostPixels) {
  ImagePyramid pyramid;
  pyramid.build(noise(64, 48));
  pyramid.build(noise(100, 60));  // buffers of another size are not kept
  for (int level = 0; level < ImagePyramid::levels; ++level) {
    const cv::Mat& now = pyramid.level(level);
    for (int row = -ImagePyramid::border; row < now.rows + ImagePyramid::border; ++row)
      for (int column = -ImagePyramid::border; column < now.cols + ImagePyramid::border; ++column)
        ASSERT_EQ(now.data[static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(now.step) + column],
                  now.at<std::uint8_t>(std::clamp(row, 0, now.rows - 1), std::clamp(column, 0, now.cols - 1)))
            << level << ": " << column << " " << row;
  }
}

TEST(ImagePyramidTest, ColourIsSeenInGrey) {
  const cv::Mat colour = noise(64, 48, CV_8UC3);
  cv::Mat grey;
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  ImagePyramid of_colour, of_grey;
  of_colour.build(colour), of_grey.build(grey);
  for (int level = 0; level < ImagePyramid::levels; ++level)
    EXPECT_LE(cv::norm(of_colour.level(level), of_grey.level(level), cv::NORM_INF), 1.0);
}

TEST(ImagePyramidTest, AnImageMayBeTooSmall) {
  ImagePyramid pyramid;
  EXPECT_TRUE(pyramid.empty());
  pyramid.build(noise(3, 5));
  EXPECT_EQ(pyramid.level(0).size(), cv::Size(1, 2));
  EXPECT_EQ(pyramid.level(1).size(), cv::Size(1, 1));
  pyramid.build(noise(1, 1));
  EXPECT_TRUE(pyramid.level(0).empty());
}

TEST(ImagePyramidTest, CornersAreStrongAndEdgesAreNot) {
  const cv::Mat image = noise(80, 60);
  ImagePyramid pyramid;
  pyramid.build(image);
  cv::Mat along_x, along_y;
  cv::Scharr(pyramid.level(0), along_x, CV_16S, 1, 0);
  cv::Scharr(pyramid.level(0), along_y, CV_16S, 0, 1);
  for (int y = 1; y < 29; ++y)
    for (int x = 1; x < 39; ++x)
      ASSERT_EQ(corner_strength(pyramid, x, y),
                std::min(std::abs(along_x.at<std::int16_t>(y, x)), std::abs(along_y.at<std::int16_t>(y, x))));
  EXPECT_EQ(corner_strength(pyramid, -1, 5), 0);
  EXPECT_EQ(corner_strength(pyramid, 5, 30), 0);
}

}  // namespace
}  // namespace holdfast
