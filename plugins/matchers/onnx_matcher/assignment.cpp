// SPDX-License-Identifier: BSD-3-Clause
#include "assignment.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::onnx_matcher_plugin {

void dual_softmax(cv::Mat& scores) {
  const auto columns = static_cast<std::size_t>(scores.cols);
  std::vector<float> largest(columns, -INFINITY), sum(columns, 0.0F);
  for (int y = 0; y < scores.rows; ++y)
    for (int x = 0; x < scores.cols; ++x)
      largest[static_cast<std::size_t>(x)] = std::max(largest[static_cast<std::size_t>(x)], scores.at<float>(y, x));
  for (int y = 0; y < scores.rows; ++y)
    for (int x = 0; x < scores.cols; ++x)
      sum[static_cast<std::size_t>(x)] += std::exp(scores.at<float>(y, x) - largest[static_cast<std::size_t>(x)]);
  for (int y = 0; y < scores.rows; ++y) {
    float* row = scores.ptr<float>(y);
    const float largest_of_row = *std::max_element(row, row + columns);
    float sum_of_row = 0.0F;
    for (std::size_t x = 0; x < columns; ++x) sum_of_row += std::exp(row[x] - largest_of_row);
    for (std::size_t x = 0; x < columns; ++x)
      row[x] = std::exp(row[x] - largest_of_row) / sum_of_row * std::exp(row[x] - largest[x]) / sum[x];
  }
}

std::vector<Assigned> mutual_best(const cv::Mat& probabilities, float threshold) {
  std::vector<int> best_column(static_cast<std::size_t>(probabilities.rows));
  for (int y = 0; y < probabilities.rows; ++y) {
    const float* row = probabilities.ptr<float>(y);
    best_column[static_cast<std::size_t>(y)] = static_cast<int>(std::max_element(row, row + probabilities.cols) - row);
  }
  std::vector<Assigned> assigned;
  for (int x = 0; x < probabilities.cols; ++x) {
    int best = 0;
    for (int y = 1; y < probabilities.rows; ++y)
      if (probabilities.at<float>(y, x) > probabilities.at<float>(best, x)) best = y;
    if (probabilities.rows == 0 || best_column[static_cast<std::size_t>(best)] != x) continue;
    const float probability = probabilities.at<float>(best, x);
    if (probability >= threshold)
      assigned.push_back({static_cast<std::uint32_t>(best), static_cast<std::uint32_t>(x), probability});
  }
  return assigned;
}

}  // namespace holdfast::onnx_matcher_plugin
