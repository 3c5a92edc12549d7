// SPDX-License-Identifier: BSD-3-Clause
#include "patch_costs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

cv::Mat noise(int rows, int columns, Random& random) {
  cv::Mat image(rows, columns, CV_8UC1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      // Black and white as well, so that sums reach their bounds.
      image.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(std::clamp(static_cast<int>(random.next() % 600) - 150, 0, 255));
  return image;
}

/// The cost of one shift, pixel by pixel, as the header states it.
int expected_cost(const cv::Mat& left, const cv::Mat& right, const PatchSearch& search, int shift) {
  const int side = 2 * search.radius + 1, top = static_cast<int>(std::floor(search.top));
  const int part = static_cast<int>(std::lround(64.0 * (search.top - top)));
  std::vector<int> differences;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const int x = search.first - search.radius + shift + column;
      const int above = right.at<std::uint8_t>(top + row, x);
      const int below = part == 0 ? 0 : right.at<std::uint8_t>(top + row + 1, x);
      differences.push_back(left.at<std::uint8_t>(search.y - search.radius + row, search.x - search.radius + column) -
                            (above * (64 - part) + below * part + 32) / 64);
    }
  const int mean = std::accumulate(differences.begin(), differences.end(), 0) / (side * side);
  return std::accumulate(differences.begin(), differences.end(), 0,
                         [mean](int sum, int difference) { return sum + std::abs(difference - mean); });
}

TEST(PatchCosts, AreTheSumsOfDifferencesAtEverySimdLevel) {
  Random random(3);
  const cv::Mat left = noise(40, 150, random), right = noise(40, 150, random);
  const cv::Mat step(40, 150, CV_8UC1, cv::Scalar(0)), inverse(40, 150, CV_8UC1, cv::Scalar(255));
  step.rowRange(10, 40).setTo(255), inverse.rowRange(10, 40).setTo(0);
  std::array<int, max_patch_shifts> costs;
  for (int trial = 0; trial < 300; ++trial) {
    const auto below = [&](int count) { return static_cast<int>(random.next() % static_cast<std::uint64_t>(count)); };
    PatchSearch search;
    search.radius = 1 + below(max_patch_radius);
    search.shifts = 1 + below(max_patch_shifts);
    const int side = 2 * search.radius + 1;
    search.x = search.radius + below(left.cols - side + 1);
    search.y = search.radius + below(left.rows - side + 1);
    search.first = search.radius + below(right.cols - side - search.shifts + 2);
    search.top = static_cast<float>(below(right.rows - side));
    if (trial % 2 == 0) search.top += static_cast<float>(random.uniform(0.0, 0.999));
    const bool is_step = trial % 10 == 0;  // the largest differences
    if (is_step)
      search.y = std::min(search.y, left.rows - search.radius - 2),
      search.top = static_cast<float>(search.y - search.radius);
    const cv::Mat &a = is_step ? step : left, &b = is_step ? inverse : right;
    for (const SimdLevel level : simd_levels) {
      if (!has_simd_level(level)) continue;
      compare_patches(a, b, search, costs, level);
      for (int shift = 0; shift < search.shifts; ++shift)
        ASSERT_EQ(costs[static_cast<std::size_t>(shift)], expected_cost(a, b, search, shift))
            << to_string(level) << ", radius " << search.radius << ", shift " << shift << " of " << search.shifts;
    }
  }
}

}  // namespace
}  // namespace holdfast
