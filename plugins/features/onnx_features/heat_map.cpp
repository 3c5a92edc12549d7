// SPDX-License-Identifier: BSD-3-Clause
#include "heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace holdfast::onnx_features_plugin {

namespace {

/// The side n of the cells of n * n + 1 channels, or 0.
int side_of_cells(int channels) {
  const int side = static_cast<int>(std::lround(std::sqrt(channels - 1)));
  return channels > 1 && side * side == channels - 1 ? side : 0;
}

cv::Mat heat_of_cells(const cv::Mat& output, int side) {
  const int rows = output.size[2], columns = output.size[3], channels = side * side + 1;
  cv::Mat heat(rows * side, columns * side, CV_32FC1);
  std::vector<float> scores(static_cast<std::size_t>(channels));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      float largest = output.ptr<float>(0, 0, row)[column];
      for (int c = 0; c < channels; ++c) largest = std::max(largest, output.ptr<float>(0, c, row)[column]);
      float sum = 0.0F;
      for (int c = 0; c < channels; ++c) {
        scores[static_cast<std::size_t>(c)] = std::exp(output.ptr<float>(0, c, row)[column] - largest);
        sum += scores[static_cast<std::size_t>(c)];
      }
      for (int c = 0; c < channels - 1; ++c)
        heat.at<float>(row * side + c / side, column * side + c % side) = scores[static_cast<std::size_t>(c)] / sum;
    }
  return heat;
}

/// Where between -0.5 and 0.5 the parabola through three values has its maximum.
float peak(float before, float at, float after) {
  const float curvature = before + after - 2.0F * at;
  return curvature < 0.0F ? std::clamp(0.5F * (before - after) / curvature, -0.5F, 0.5F) : 0.0F;
}

bool is_maximum(const cv::Mat& heat, int x, int y, int radius) {
  const float score = heat.at<float>(y, x);
  for (int row = std::max(y - radius, 0); row <= std::min(y + radius, heat.rows - 1); ++row) {
    const float* scores = heat.ptr<float>(row);
    for (int column = std::max(x - radius, 0); column <= std::min(x + radius, heat.cols - 1); ++column) {
      const bool is_before = row < y || (row == y && column < x);
      if (scores[column] > score || (is_before && scores[column] == score)) return false;
    }
  }
  return true;
}

/// The `count` points of the largest scores in reading order; of equal ones the first.
std::vector<HeatPoint> strongest(std::vector<HeatPoint> points, std::size_t count) {
  if (points.size() <= count) return points;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a].score > points[b].score; });
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<HeatPoint> kept;
  kept.reserve(count);
  for (const std::size_t i : order) kept.push_back(points[i]);
  return kept;
}

}  // namespace

cv::Mat heat_map_of(const cv::Mat& output) {
  if (output.dims == 4 && output.size[0] == 1 && output.size[1] == 1)
    return {output.size[2], output.size[3], CV_32FC1, output.data};
  if (output.dims == 3 && output.size[0] == 1) return {output.size[1], output.size[2], CV_32FC1, output.data};
  if (output.dims != 4 || output.size[0] != 1) return {};
  const int side = side_of_cells(output.size[1]);
  return side > 1 ? heat_of_cells(output, side) : cv::Mat();
}

std::vector<HeatPoint> keypoints_of(const cv::Mat& heat, const HeatMapSettings& settings) {
  std::vector<HeatPoint> points;
  const int border = std::max(settings.border, 1);  // a maximum needs its neighbours
  for (int y = border; y < heat.rows - border; ++y) {
    const float* scores = heat.ptr<float>(y);
    for (int x = border; x < heat.cols - border; ++x) {
      if (!(scores[x] >= settings.threshold) || scores[x] < scores[x - 1] || scores[x] < scores[x + 1]) continue;
      if (!is_maximum(heat, x, y, settings.suppression_radius)) continue;
      HeatPoint point{static_cast<float>(x), static_cast<float>(y), scores[x]};
      if (settings.subpixel) {
        point.x += peak(scores[x - 1], scores[x], scores[x + 1]);
        point.y += peak(heat.at<float>(y - 1, x), scores[x], heat.at<float>(y + 1, x));
      }
      points.push_back(point);
    }
  }
  return strongest(std::move(points), settings.count);
}

}  // namespace holdfast::onnx_features_plugin
