// SPDX-License-Identifier: BSD-3-Clause
#include "window_costs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

cv::Mat noise(int rows, int columns, int type, double least, double most, Random& random) {
  cv::Mat image(rows, columns, type);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double value = random.uniform(least, most);
      if (type == CV_8UC1)
        image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(value);
      else
        image.at<std::int16_t>(row, column) = static_cast<std::int16_t>(value);
    }
  return image;
}

/// Differences of one candidate, pixel by pixel, as the header states them; 40 grey levels where there is none.
cv::Mat differences(const cv::Mat& left, const cv::Mat& right, const cv::Mat& half, int candidate) {
  cv::Mat result(left.size(), CV_8UC1, cv::Scalar(40));
  for (int row = 0; row < left.rows; ++row)
    for (int column = 0; column < left.cols; ++column) {
      const int found = WindowCosts::half_row(half, row)[std::min(column / 2, half.cols - 1)];
      const int place = 8 * column - found, whole = place >> 3, part = place & 7;
      if (found < 8 || whole < 2 || whole + 3 >= left.cols) continue;
      const std::uint8_t* from = right.ptr<std::uint8_t>(row) + whole - 2 + candidate;
      const int value = (from[0] * (8 - part) + from[1] * part + 4) / 8;
      result.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(std::min(std::abs(left.at<std::uint8_t>(row, column) - value), 40));
    }
  return result;
}

TEST(WindowCosts, AreTheBoxFiltersOfTheDifferences) {
  Random random(5);
  WindowCosts costs;
  for (const cv::Size size : {cv::Size(40, 30), cv::Size(9, 7), cv::Size(5, 3), cv::Size(2, 1), cv::Size(33, 4)}) {
    const cv::Mat left = noise(size.height, size.width, CV_8UC1, 0, 255.9, random);
    const cv::Mat right = noise(size.height, size.width, CV_8UC1, 0, 255.9, random);
    const cv::Mat half =
        noise(std::max(1, size.height / 2), std::max(1, size.width / 2), CV_16SC1, -16, 8.0 * size.width, random);
    std::array<cv::Mat, WindowCosts::candidates> expected;
    for (int k = 0; k < WindowCosts::candidates; ++k)
      cv::boxFilter(differences(left, right, half, k), expected[static_cast<std::size_t>(k)], CV_16U,
                    cv::Size(WindowCosts::window, WindowCosts::window), cv::Point(-1, -1), false);
    costs.begin(left, right, half);
    for (int row = 0; row < size.height; ++row) {
      const WindowCosts::Lanes* found = costs.next_row();
      for (int column = 0; column < size.width; ++column) {
        for (int k = 0; k < WindowCosts::candidates; ++k) {
          const int cost = expected[static_cast<std::size_t>(k)].at<std::uint16_t>(row, column);
          EXPECT_EQ(found[column][k], cost) << size << " " << column << " " << row << " " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace holdfast
