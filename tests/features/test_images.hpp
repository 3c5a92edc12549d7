// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"
#include "holdfast/core/simd.hpp"

namespace holdfast::test {

inline cv::Mat noise_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.below(256));
  return image;
}

/// Overlapping boxes and discs of many sizes with soft edges and a little noise: corners as in pictures of rooms.
inline cv::Mat scene_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  const int count = width * height / 700;
  for (int i = 0; i < count; ++i) {
    const int y = static_cast<int>(random.below(height)), x = static_cast<int>(random.below(width));
    const cv::Point at(x, y);
    const cv::Scalar grey(random.below(256));
    if (i % 3 == 0)
      cv::circle(image, at, 3 + static_cast<int>(random.below(20)), grey, cv::FILLED);
    else
      cv::rectangle(image, {at.x, at.y, 4 + static_cast<int>(random.below(50)), 4 + static_cast<int>(random.below(50))},
                    grey, cv::FILLED);
  }
  cv::GaussianBlur(image, image, {5, 5}, 1.0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint8_t& pixel = image.at<std::uint8_t>(y, x);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + 2.0 * random.normal());
    }
  return image;
}

/// Every SIMD level that this processor has.
inline std::vector<SimdLevel> available_simd_levels() {
  std::vector<SimdLevel> levels;
  for (const SimdLevel level : simd_levels)
    if (has_simd_level(level)) levels.push_back(level);
  return levels;
}

}  // namespace holdfast::test
