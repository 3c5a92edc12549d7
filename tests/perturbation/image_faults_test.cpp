// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/perturbation/image_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace holdfast {
namespace {

/// A white column on black.
cv::Mat column_image(int column) {
  cv::Mat image = cv::Mat::zeros(20, 40, CV_8UC3);
  image.col(column).setTo(cv::Scalar::all(255));
  return image;
}

int red(const cv::Mat& image, int y, int x) { return image.at<cv::Vec3b>(y, x)[2]; }

TEST(ImageFaultsTest, BrightnessIsRoundedAndSaturated) {
  const cv::Mat image(2, 2, CV_8UC1, cv::Scalar(101));
  EXPECT_EQ(scaled_brightness(image, 0.5).at<std::uint8_t>(0, 0), 50);  // 50.5 to the even number
  EXPECT_EQ(scaled_brightness(image, 3.0).at<std::uint8_t>(1, 1), 255);
  EXPECT_EQ(image.at<std::uint8_t>(0, 0), 101) << "the argument is unchanged";
}

TEST(ImageFaultsTest, NoiseHasItsStandardDeviationAndFollowsTheSeed) {
  const cv::Mat image(120, 160, CV_8UC3, cv::Scalar::all(128));
  const cv::Mat noisy = with_noise(image, 10.0, Random(3));
  cv::Scalar mean, deviation;
  cv::meanStdDev(noisy, mean, deviation);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 128.0, 0.5);
    EXPECT_NEAR(deviation[c], 10.0, 0.3);
  }
  EXPECT_EQ(cv::norm(noisy, with_noise(image, 10.0, Random(3)), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(noisy, with_noise(image, 10.0, Random(4)), cv::NORM_INF), 0.0);
}

TEST(ImageFaultsTest, BlurSpreadsAColumnAcrossAndLeavesItAlong) {
  const cv::Mat across = blurred(column_image(20), 8.0, 0.0);
  EXPECT_EQ(red(across, 10, 16), 255 / 9);
  EXPECT_EQ(red(across, 10, 24), 255 / 9);
  EXPECT_EQ(red(across, 10, 15), 0);
  const cv::Mat along = blurred(column_image(20), 8.0, std::numbers::pi / 2.0);
  EXPECT_EQ(cv::norm(along, column_image(20), cv::NORM_INF), 0.0);
  // What is outside of the image is like its border.
  EXPECT_EQ(red(blurred(column_image(0), 8.0, 0.0), 3, 0), (5 * 255 + 4) / 9);
  EXPECT_EQ(red(blurred(column_image(39), 8.0, 0.0), 3, 39), (5 * 255 + 4) / 9);
  EXPECT_EQ(cv::norm(blurred(column_image(20), 500.0, 0.3) > 255, cv::NORM_INF), 0.0) << "longer than the image";
}

TEST(ImageFaultsTest, ShearMovesTheFirstAndTheLastRowApart) {
  const cv::Mat skewed = sheared(column_image(20), 6.0);
  EXPECT_EQ(red(skewed, 0, 17), 255);
  EXPECT_EQ(red(skewed, 19, 23), 255);
  cv::Mat depth = cv::Mat::zeros(20, 40, CV_32FC1);
  depth.col(20).setTo(2.0);
  const cv::Mat moved = sheared_values(depth, 6.0);
  EXPECT_EQ(moved.at<float>(0, 17), 2.0F);
  EXPECT_EQ(moved.at<float>(19, 23), 2.0F);
  EXPECT_EQ(cv::countNonZero(moved), 20) << "no depth between the surfaces appears";
  EXPECT_EQ(cv::countNonZero(sheared_values(depth, 200.0)), 4) << "rows that leave the image";
}

TEST(ImageFaultsTest, ShiftFillsWithZero) {
  cv::Mat depth(4, 6, CV_32FC1, cv::Scalar(1.0));
  depth.at<float>(1, 2) = 5.0F;
  const cv::Mat moved = shifted(depth, 2, -1);
  EXPECT_EQ(moved.at<float>(0, 4), 5.0F);
  EXPECT_EQ(cv::countNonZero(moved), 3 * 4);
  EXPECT_EQ(cv::countNonZero(shifted(depth, 100, 100)), 0);
}

TEST(ImageFaultsTest, HolesCoverTheirShare) {
  const cv::Mat depth(120, 160, CV_32FC1, cv::Scalar(1.5));
  for (const double share : {0.1, 0.5, 0.9})
    EXPECT_NEAR(1.0 - cv::countNonZero(with_holes(depth, share, Random(7))) / 19200.0, share, 1e-3);
}

}  // namespace
}  // namespace holdfast
