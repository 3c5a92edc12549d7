// SPDX-License-Identifier: BSD-3-Clause
#include "semi_global_stereo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace holdfast {

namespace {

constexpr int sixteenths = 16;                 // of a pixel, the unit of OpenCV's disparities
constexpr int eighths = WindowCosts::eighths;  // of a pixel of the full resolution: the same unit at half of it
constexpr int step = 16;                       // the number of disparities that OpenCV searches is a multiple of it

/// The least number of disparities that OpenCV can search up to this one [px].
int in_steps(double disparity) { return std::max(1, static_cast<int>(std::ceil(disparity / step))) * step; }

/// `block`: size of the compared blocks [px]. `speckle_size`: smaller regions of like disparities are taken for errors
/// [pixels].
cv::Ptr<cv::StereoSGBM> make_matcher(int block, int speckle_size) {
  constexpr int uniqueness = 10, speckle_range = 2, left_right = 1;
  // The penalties that OpenCV's documentation recommends.
  return cv::StereoSGBM::create(0, step, block, 8 * block * block, 32 * block * block, left_right, 0, uniqueness,
                                speckle_size, speckle_range, cv::StereoSGBM::MODE_SGBM_3WAY);
}

void halve(const cv::Mat& image, cv::Mat& half) {
  cv::resize(image, half, cv::Size(image.cols / 2, image.rows / 2), 0, 0, cv::INTER_AREA);
}

}  // namespace

SemiGlobalStereo::SemiGlobalStereo(double max_disparity, int width)
    : disparities_(in_steps(std::min(max_disparity, 0.5 * width) / 2.0)),
      matcher_(make_matcher(5, 60)),
      coarse_matcher_(make_matcher(3, 4)) {}

void SemiGlobalStereo::match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity) {
  halve(left, half_left_);
  halve(right, half_right_);
  match_padded(*matcher_, half_left_, half_right_, needed_disparities(), half_disparity_);
  right.convertTo(right_, CV_8U, 1.0, brightness_difference());
  costs_.begin(left, right_, half_disparity_);
  refine(disparity);
  remove_occluded(disparity);
}

int SemiGlobalStereo::needed_disparities() {
  constexpr int coarser = 4, margin = 2;
  constexpr double least_share = 0.001;  // of the pixels
  halve(half_left_, quarter_);
  halve(quarter_, coarse_left_);
  halve(half_right_, quarter_);
  halve(quarter_, coarse_right_);
  match_padded(*coarse_matcher_, coarse_left_, coarse_right_, in_steps(disparities_ / coarser), coarse_disparity_);
  std::vector<int> counts(static_cast<std::size_t>(disparities_ / coarser + step), 0);
  for (int row = 0; row < coarse_disparity_.rows; ++row)
    for (int column = 0; column < coarse_disparity_.cols; ++column)
      ++counts[static_cast<std::size_t>(
          std::max<int>(coarse_disparity_.ptr<std::int16_t>(row)[column] / sixteenths, 0))];
  const int least = static_cast<int>(least_share * static_cast<double>(coarse_disparity_.total()));
  int disparity = static_cast<int>(counts.size()) - 1;
  for (int nearer = counts.back(); disparity > 0 && nearer <= least;
       nearer += counts[static_cast<std::size_t>(disparity)])
    --disparity;
  return std::min(in_steps(coarser * (disparity + margin)), disparities_);
}

void SemiGlobalStereo::match_padded(cv::StereoSGBM& matcher, const cv::Mat& left, const cv::Mat& right, int disparities,
                                    cv::Mat& result) {
  cv::copyMakeBorder(left, padded_left_, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right, padded_right_, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  matcher.setNumDisparities(disparities);
  matcher.compute(padded_left_, padded_right_, padded_disparity_);
  padded_disparity_.colRange(disparities, padded_disparity_.cols).copyTo(result);
}

int SemiGlobalStereo::brightness_difference() const {
  constexpr int levels = 256;
  std::array<int, 2 * levels> counts{};
  int total = 0;
  for (int row = 0; row < half_left_.rows; ++row) {
    const std::uint8_t *left = half_left_.ptr<std::uint8_t>(row), *right = half_right_.ptr<std::uint8_t>(row);
    const std::int16_t* disparity = half_disparity_.ptr<std::int16_t>(row);
    for (int column = 0; column < half_left_.cols; ++column) {
      const int there = column - (disparity[column] + eighths) / sixteenths;
      if (disparity[column] < eighths || there < 0) continue;
      ++counts[static_cast<std::size_t>(left[column] - right[there] + levels)];
      ++total;
    }
  }
  int level = 0;
  for (int passed = counts[0]; 2 * passed < total; passed += counts[static_cast<std::size_t>(level)]) ++level;
  return total == 0 ? 0 : level - levels;
}

void SemiGlobalStereo::refine(cv::Mat& disparity) {
  constexpr int candidates = WindowCosts::candidates;
  constexpr int distinct = WindowCosts::window * WindowCosts::window / 4;  // a quarter of a grey level
  const int rows = right_.rows, columns = right_.cols, last = half_disparity_.cols - 1;
  disparity.create(rows, columns, CV_32FC1);
  least_.create(rows, columns, CV_16UC1);
  for (int row = 0; row < rows; ++row) {
    const std::int16_t* half = WindowCosts::half_row(half_disparity_, row);
    const WindowCosts::Lanes* costs = costs_.next_row();
    float* to = disparity.ptr<float>(row);
    auto* least_to = least_.ptr<std::uint16_t>(row);
    for (int column = 0; column < columns; ++column) {
      to[column] = 0.0F;
      least_to[column] = 0;
      const int found = half[std::min(column / 2, last)];
      if (found < eighths) continue;
      const int best = WindowCosts::least_lane(costs[column]);
      if (best == 0 || best + 1 == candidates) continue;
      const WindowCosts::Lanes cost = costs[column];
      const int least = cost[best], before = cost[best + 1] - least, after = cost[best - 1] - least,
                rise = std::max(before, after);
      if (rise <= distinct) continue;
      const float offset = 0.5F * static_cast<float>(before - after) / static_cast<float>(rise);
      const float value = static_cast<float>(found) / eighths + static_cast<float>(WindowCosts::reach - best) + offset;
      to[column] = std::max(value, 0.0F);
      least_to[column] = static_cast<std::uint16_t>(least);
    }
  }
}

void SemiGlobalStereo::remove_occluded(cv::Mat& disparity) {
  constexpr float tolerance = 1.5F;  // px; a slanted surface shows several disparities in one column
  const int columns = disparity.cols;
  places_.resize(static_cast<std::size_t>(columns));
  for (int row = 0; row < disparity.rows; ++row) {
    float* values = disparity.ptr<float>(row);
    for (int column = 0; column < columns; ++column)
      places_[static_cast<std::size_t>(column)] = std::max(column - static_cast<int>(values[column] + 0.5F), 0);
    const std::uint16_t* costs = least_.ptr<std::uint16_t>(row);
    best_.assign(static_cast<std::size_t>(columns), -1);
    const auto best_of = [&](int column) -> int& {
      return best_[static_cast<std::size_t>(places_[static_cast<std::size_t>(column)])];
    };
    for (int column = 0; column < columns; ++column) {
      if (values[column] == 0.0F) continue;
      int& best = best_of(column);
      if (best < 0 || costs[column] < costs[best]) best = column;
    }
    for (int column = 0; column < columns; ++column)
      if (values[column] > 0.0F && std::abs(values[best_of(column)] - values[column]) > tolerance)
        removed_.push_back(column);
    for (const int column : removed_) values[column] = 0.0F;
    removed_.clear();
  }
}

}  // namespace holdfast
