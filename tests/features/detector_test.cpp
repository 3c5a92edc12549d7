// SPDX-License-Identifier: BSD-3-Clause
#include "detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "features/test_images.hpp"

namespace holdfast::orb_plugin {
namespace {

ImageView view(const cv::Mat& image) {
  return {image.data, static_cast<std::ptrdiff_t>(image.step), image.cols, image.rows};
}

bool nothing_ignored(int, int) { return false; }

/// A left half with strong corners and a right half with weak ones (about 15 grey levels).
cv::Mat strong_and_weak() {
  cv::Mat image(200, 400, CV_8UC1, cv::Scalar(100));
  for (int y = 30; y < 180; y += 24)
    for (int x = 30; x < 380; x += 24) cv::rectangle(image, {x, y, 8, 8}, cv::Scalar(x < 200 ? 200 : 115), cv::FILLED);
  return image;
}

TEST(CornerDetector, SearchesEmptyCellsWithTheLowThreshold) {
  const cv::Mat image = strong_and_weak();
  const auto weak = [](const std::vector<Corner>& corners) {
    return std::count_if(corners.begin(), corners.end(), [](const Corner& c) { return c.x > 210; });
  };
  std::vector<Corner> with, without;
  CornerDetector(20, 7, 32, kernels(simd_level())).detect(view(image), nothing_ignored, with);
  CornerDetector(20, 20, 32, kernels(simd_level())).detect(view(image), nothing_ignored, without);
  EXPECT_EQ(weak(without), 0);
  EXPECT_GT(weak(with), 40);
  EXPECT_GT(without.size(), 40U);
  // Where the threshold found corners nothing was added: those of the left half are the same.
  EXPECT_EQ(static_cast<std::ptrdiff_t>(with.size()) - weak(with), static_cast<std::ptrdiff_t>(without.size()));
}

TEST(CornerDetector, IgnoredCornersDoNotClaimACell) {
  const cv::Mat image = strong_and_weak();
  std::vector<Corner> corners;
  CornerDetector detector(20, 7, 32, kernels(simd_level()));
  detector.detect(
      view(image), [](int x, int) { return x < 210; }, corners);
  EXPECT_GT(corners.size(), 40U);
  for (const Corner& corner : corners) EXPECT_GE(corner.x, 210);
}

TEST(CornerDetector, KeepsTheBorderAndFindsNoNeighbours) {
  const cv::Mat image = test::scene_image(203, 151, 1);
  std::vector<Corner> corners;
  CornerDetector(20, 7, 32, kernels(simd_level())).detect(view(image), nothing_ignored, corners);
  ASSERT_GT(corners.size(), 50U);
  for (const Corner& a : corners) {
    EXPECT_GE(std::min<int>(a.x, a.y), CornerDetector::border);
    EXPECT_LT(a.x, image.cols - CornerDetector::border);
    EXPECT_LT(a.y, image.rows - CornerDetector::border);
  }
}

TEST(CornerDetector, ALaterSmallerImageIsNotTouchedByAnEarlierLargerOne) {
  const cv::Mat large = test::noise_image(300, 200, 2), small = test::scene_image(100, 80, 3);
  CornerDetector used(20, 7, 32, kernels(simd_level())), fresh(20, 7, 32, kernels(simd_level()));
  std::vector<Corner> a, b;
  used.detect(view(large), nothing_ignored, a);
  used.detect(view(small), nothing_ignored, a);
  fresh.detect(view(small), nothing_ignored, b);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_TRUE(a[i].x == b[i].x && a[i].y == b[i].y && a[i].score == b[i].score);
}

}  // namespace
}  // namespace holdfast::orb_plugin
