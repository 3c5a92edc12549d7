// SPDX-License-Identifier: BSD-3-Clause
// Every kernel of every SIMD level against the plain one, and the plain ones against OpenCV or the definition.
#include "kernels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include <opencv2/features2d.hpp>

#include "brief.hpp"
#include "features/test_images.hpp"

namespace holdfast::orb_plugin {
namespace {

ImageView view_of(const cv::Mat& image) {
  return {image.data, static_cast<std::ptrdiff_t>(image.step), image.cols, image.rows};
}

cv::Mat fast_scores(const Kernels& kernels, const cv::Mat& image, int threshold) {
  cv::Mat scores(image.rows, image.cols, CV_8UC1, cv::Scalar(0));
  kernels.fast_scores({image.ptr(3) + 3, static_cast<std::ptrdiff_t>(image.step), image.cols - 6, image.rows - 6},
                      threshold, {scores.ptr(3) + 3, static_cast<std::ptrdiff_t>(scores.step)});
  return scores;
}

bool is_same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

/// Images of odd sizes, one of them a part of a larger image.
std::vector<cv::Mat> samples() {
  return {test::scene_image(131, 67, 1), test::noise_image(97, 31, 2), test::scene_image(39, 45, 3),
          test::noise_image(23, 20, 4), test::scene_image(200, 100, 5)(cv::Rect(13, 7, 101, 60))};
}

TEST(Kernels, FastScoresAreTheSameAtEveryLevel) {
  for (const cv::Mat& image : samples())
    for (const int threshold : {1, 7, 20, 100, 254}) {
      const cv::Mat expected = fast_scores(scalar_kernels(), image, threshold);
      for (const SimdLevel level : test::available_simd_levels())
        EXPECT_TRUE(is_same(fast_scores(kernels(level), image, threshold), expected))
            << to_string(level) << " " << image.size() << " " << threshold;
    }
}

TEST(Kernels, FastCornersAreThoseOfOpencv) {
  for (const cv::Mat& image : samples())
    for (const int threshold : {7, 20, 60}) {
      std::vector<cv::KeyPoint> expected;
      cv::FAST(image, expected, threshold, /*nonmaxSuppression=*/false, cv::FastFeatureDetector::TYPE_9_16);
      cv::Mat corners(image.size(), CV_8UC1, cv::Scalar(0));
      for (const cv::KeyPoint& keypoint : expected) corners.at<std::uint8_t>(keypoint.pt) = 255;
      EXPECT_TRUE(is_same(fast_scores(scalar_kernels(), image, threshold) > 0, corners)) << image.size();
    }
}

TEST(Kernels, FastScoreIsTheLargestThresholdAsInOpencv) {
  const cv::Mat image = test::scene_image(160, 120, 6);
  std::vector<cv::KeyPoint> maxima;
  cv::FAST(image, maxima, 20, /*nonmaxSuppression=*/true);
  ASSERT_GT(maxima.size(), 50U);
  const cv::Mat scores = fast_scores(scalar_kernels(), image, 20);
  for (const cv::KeyPoint& keypoint : maxima) EXPECT_EQ(scores.at<std::uint8_t>(keypoint.pt), keypoint.response);
}

TEST(Kernels, NeighbourScoresAreThoseOfTheImage) {
  const cv::Mat image = test::scene_image(120, 90, 7), scores = fast_scores(scalar_kernels(), image, 1);
  for (const SimdLevel level : test::available_simd_levels())
    for (int y = 19; y < 71; ++y)
      for (int x = 19; x < 101; ++x) {
        std::uint8_t found[9];
        kernels(level).neighbour_scores(image.ptr(y) + x, static_cast<std::ptrdiff_t>(image.step), found);
        for (int i = 0; i < 9; ++i)
          ASSERT_EQ(found[i], scores.at<std::uint8_t>(y + i / 3 - 1, x + i % 3 - 1))
              << to_string(level) << x << " " << y;
      }
}

TEST(Kernels, LocalMaximaKeepOneOfEqualNeighbours) {
  cv::Mat scores(5, 80, CV_8UC1, cv::Scalar(0));
  scores.at<std::uint8_t>(2, 10) = scores.at<std::uint8_t>(2, 11) = 9;     // a plateau
  scores.at<std::uint8_t>(2, 20) = 5, scores.at<std::uint8_t>(1, 21) = 6;  // beaten from above
  scores.at<std::uint8_t>(2, 40) = 200, scores.at<std::uint8_t>(3, 39) = 199;
  scores.at<std::uint8_t>(2, 70) = 1;
  for (const SimdLevel level : test::available_simd_levels()) {
    std::uint16_t columns[80];
    const int count = kernels(level).local_maxima(scores.ptr(2) + 1, 80, 78, columns);
    EXPECT_EQ(std::vector<int>(columns, columns + count), (std::vector<int>{9, 39, 69})) << to_string(level);
  }
}

TEST(Kernels, LocalMaximaAreTheSameAtEveryLevel) {
  Random random(8);
  for (const int width : {5, 17, 32, 33, 63, 100}) {
    cv::Mat scores(3, width + 2, CV_8UC1);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < width + 2; ++x)
        scores.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.below(4) == 0 ? random.below(4) : 0);
    std::vector<std::uint16_t> expected(width), found(width);
    const int expected_count = scalar_kernels().local_maxima(scores.ptr(1) + 1, width + 2, width, expected.data());
    for (const SimdLevel level : test::available_simd_levels()) {
      EXPECT_EQ(kernels(level).local_maxima(scores.ptr(1) + 1, width + 2, width, found.data()), expected_count);
      EXPECT_TRUE(std::equal(expected.begin(), expected.begin() + expected_count, found.begin())) << to_string(level);
    }
  }
}

cv::Mat resized(const Kernels& kernels, const cv::Mat& image, cv::Size size) {
  ResizeAxis columns, rows;
  columns.build(image.cols, size.width);
  rows.build(image.rows, size.height);
  std::vector<std::uint8_t> row(image.cols + 32);
  cv::Mat output(size, CV_8UC1);
  kernels.resize(view_of(image), columns, rows, row.data(), {output.data, static_cast<std::ptrdiff_t>(output.step)});
  return output;
}

TEST(Kernels, ResizeIsBilinearAndTheSameAtEveryLevel) {
  for (const cv::Mat& image : samples())
    for (const double factor : {1.05, 1.2, 1.5, 2.0, 2.9}) {
      const cv::Size size(static_cast<int>(image.cols / factor), static_cast<int>(image.rows / factor));
      const cv::Mat expected = resized(scalar_kernels(), image, size);
      cv::Mat reference;
      cv::resize(image, reference, size, 0, 0, cv::INTER_LINEAR);
      EXPECT_LE(cv::norm(expected, reference, cv::NORM_INF), 5) << factor;  // weights are in 1/128
      for (const SimdLevel level : test::available_simd_levels())
        EXPECT_TRUE(is_same(resized(kernels(level), image, size), expected)) << to_string(level) << " " << factor;
    }
}

cv::Mat blurred(const Kernels& kernels, const cv::Mat& image) {
  std::vector<std::uint8_t> rows(2 * static_cast<std::size_t>(image.cols));
  cv::Mat output(image.size(), CV_8UC1, cv::Scalar(0));
  kernels.blur(view_of(image), rows.data(), {output.data, static_cast<std::ptrdiff_t>(output.step)});
  return output;
}

TEST(Kernels, BlurIsGaussianAndTheSameAtEveryLevel) {
  for (const cv::Mat& image : samples()) {
    const cv::Mat expected = blurred(scalar_kernels(), image);
    cv::Mat reference;
    cv::GaussianBlur(image, reference, {7, 7}, 2.0);
    const cv::Rect inner(blur_radius, blur_radius, image.cols - 2 * blur_radius, image.rows - 2 * blur_radius);
    EXPECT_LE(cv::norm(expected(inner), reference(inner), cv::NORM_INF), 3);
    for (const SimdLevel level : test::available_simd_levels())
      EXPECT_TRUE(is_same(blurred(kernels(level), image), expected)) << to_string(level);
  }
}

TEST(Kernels, PatchIsADisc) {
  for (int y = 0; y <= patch_radius; ++y) {
    const double half_width = std::sqrt((patch_radius + 0.5) * (patch_radius + 0.5) - y * y);
    EXPECT_EQ(patch_half_width[y], std::min(patch_radius, static_cast<int>(half_width))) << y;
  }
}

TEST(Kernels, MomentsAndDescriptorsAreTheSameAtEveryLevel) {
  const cv::Mat image = test::noise_image(90, 50, 9);
  SteeredPattern pattern;
  pattern.build(static_cast<std::ptrdiff_t>(image.step));
  for (int x = 20; x < 70; ++x) {
    const std::uint8_t* centre = image.ptr(24) + x;
    int expected_x = 0, expected_y = 0, found_x = 0, found_y = 0;
    scalar_kernels().moments(centre, static_cast<std::ptrdiff_t>(image.step), expected_x, expected_y);
    Descriptor256 expected, found;
    const std::int32_t* offsets = pattern.offsets(static_cast<float>(x) * 0.06F);
    scalar_kernels().describe(centre, offsets, expected);
    for (const SimdLevel level : test::available_simd_levels()) {
      kernels(level).moments(centre, static_cast<std::ptrdiff_t>(image.step), found_x, found_y);
      EXPECT_EQ(std::pair(found_x, found_y), std::pair(expected_x, expected_y)) << to_string(level);
      kernels(level).describe(centre, offsets, found);
      EXPECT_EQ(found, expected) << to_string(level);
    }
  }
}

TEST(Brief, SamplesStayWithinTheRadiusAtEveryAngle) {
  constexpr std::ptrdiff_t stride = 1000;
  SteeredPattern pattern;
  pattern.build(stride);
  for (int step = 0; step < SteeredPattern::steps; ++step) {
    const std::int32_t* offsets = pattern.offsets(static_cast<float>(step * 2 * 3.14159265 / SteeredPattern::steps));
    for (int i = 0; i < 512; ++i) {
      const auto y = static_cast<int>(std::lround(offsets[i] / static_cast<double>(stride)));
      const int x = offsets[i] - static_cast<int>(y * stride);
      ASSERT_LE(std::max(std::abs(x), std::abs(y)), brief_radius);
    }
  }
}

TEST(Brief, TestsAreDistinct) {
  std::set<std::pair<std::pair<int, int>, std::pair<int, int>>> seen;
  for (const BriefTest& test : brief_pattern())
    EXPECT_TRUE(
        seen.insert(std::minmax(std::pair<int, int>(test.x1, test.y1), std::pair<int, int>(test.x2, test.y2))).second);
}

}  // namespace
}  // namespace holdfast::orb_plugin
