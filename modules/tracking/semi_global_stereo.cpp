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

namespace {

constexpr int lanes = 8;
/// Eight pixels with eight costs each, as eight costs of eight pixels.
HOLDFAST_INLINE void transpose(EightWords* rows) {
  for (int half = 0; half < 3; ++half) {
    EightWords result[lanes];
    for (int k = 0; k < lanes / 2; ++k) {
      result[2 * k] = __builtin_shufflevector(rows[k], rows[k + 4], 0, 8, 1, 9, 2, 10, 3, 11);
      result[2 * k + 1] = __builtin_shufflevector(rows[k], rows[k + 4], 4, 12, 5, 13, 6, 14, 7, 15);
    }
    std::copy_n(result, lanes, rows);
  }
}

/// Of eight pixels: the least cost, its candidate, and how much more the neighbours' costs are.
struct Minima {
  EightWords least, best, before, after;
};

HOLDFAST_INLINE Minima find_minima(const WindowCosts::Lanes* costs) {
  EightWords cost[lanes];
  std::copy_n(costs, lanes, cost);
  transpose(cost);
  // Of equal costs that of the largest lane.
  Minima minima{cost[0], {}, cost[1], {}};
  for (std::int16_t k = 1; k < WindowCosts::candidates; ++k) {
    const EightWords is_less = cost[k] <= minima.least;
    minima.least = is_less ? cost[k] : minima.least;
    minima.best = is_less ? EightWords{} + k : minima.best;
    minima.before = is_less ? cost[k + 1] : minima.before;
    minima.after = is_less ? cost[k - 1] : minima.after;
  }
  minima.before -= minima.least;
  minima.after -= minima.least;
  return minima;
}

/// Sets the refined disparities of eight pixels, 0 where there is none, and their least costs, -1 where there is none.
/// `found_at`: disparities of half the resolution [1/8 px].
HOLDFAST_INLINE void refine_eight(const WindowCosts::Lanes* costs, const std::int16_t* found_at, float* disparity,
                                  std::int16_t* least) {
  constexpr std::int16_t distinct = WindowCosts::window * WindowCosts::window / 4;  // a quarter of a grey level
  const Minima minima = find_minima(costs);
  const EightWords rise = minima.before > minima.after ? minima.before : minima.after;
  const EightWords found = lanes_at<EightWords>(found_at);
  const EightWords is_known = (found >= std::int16_t{eighths}) & (minima.best != 0) &
                              (minima.best != std::int16_t{WindowCosts::candidates - 1}) & (rise > distinct);
  const EightWords difference = minima.before - minima.after,
                   divisor = is_known ? rise : EightWords{} + std::int16_t{1},
                   shift = std::int16_t{WindowCosts::reach} - minima.best;
  EightWords is_positive;
  for (int half = 0; half < lanes; half += lanes / 2) {
    const auto numbers = [half](const EightWords& words) __attribute__((always_inline)) {
      const FourWords part = half == 0 ? __builtin_shufflevector(words, words, 0, 1, 2, 3)
                                       : __builtin_shufflevector(words, words, 4, 5, 6, 7);
      return __builtin_convertvector(part, FourFloats);
    };
    const FourFloats offset = 0.5F * numbers(difference) / numbers(divisor);
    const FourFloats value = numbers(found) / static_cast<float>(eighths) + numbers(shift) + offset;
    const auto known = (numbers(is_known) != 0.0F) & (value > 0.0F);
    store(known ? value : FourFloats{}, disparity + half);
    for (int k = 0; k < lanes / 2; ++k) is_positive[half + k] = static_cast<std::int16_t>(known[k]);
  }
  store((minima.least & is_positive) | ~is_positive, least);
}

}  // namespace

void SemiGlobalStereo::refine(cv::Mat& disparity) {
  const int rows = right_.rows, columns = right_.cols, last = half_disparity_.cols - 1;
  const std::size_t padded = static_cast<std::size_t>(columns + lanes - 1) / lanes * lanes;
  disparity.create(rows, columns, CV_32FC1);
  found_.resize(padded), least_.resize(padded), refined_.resize(padded);
  for (int row = 0; row < rows; ++row) {
    const std::int16_t* half = WindowCosts::half_row(half_disparity_, row);
    for (int k = 0; k <= last; ++k)
      found_[static_cast<std::size_t>(2 * k)] = found_[static_cast<std::size_t>(2 * k + 1)] = half[k];
    if (columns % 2 != 0) found_[static_cast<std::size_t>(columns - 1)] = half[last];
    const WindowCosts::Lanes* costs = costs_.next_row();
    for (std::size_t column = 0; column < padded; column += lanes)
      refine_eight(costs + column, found_.data() + column, refined_.data() + column, least_.data() + column);
    remove_occluded(columns, disparity.ptr<float>(row));
  }
}

void SemiGlobalStereo::remove_occluded(int columns, float* disparity) {
  constexpr float tolerance = 1.5F;  // px; a slanted surface shows several disparities in one column
  constexpr std::uint32_t column_bits = 16, column_mask = (1U << column_bits) - 1;
  const auto count = static_cast<std::size_t>(columns);
  places_.resize(count), shown_.resize(refined_.size());
  best_.assign(count, ~std::uint32_t{0});
  for (std::size_t column = 0; column < count; ++column)
    places_[column] = std::max(static_cast<int>(column) - static_cast<int>(refined_[column] + 0.5F), 0);
  // The least cost, and of equal ones the left column, in one number; pixels without a disparity have the largest one.
  for (std::size_t column = 0; column < count; ++column) {
    std::uint32_t& best = best_[static_cast<std::size_t>(places_[column])];
    const auto cost = static_cast<std::uint16_t>(least_[column]);
    best = std::min(best, std::uint32_t{cost} << column_bits | static_cast<std::uint32_t>(column));
  }
  for (std::size_t column = 0; column < count; ++column)
    shown_[column] = refined_[best_[static_cast<std::size_t>(places_[column])] & column_mask];
  for (std::size_t column = 0; column < refined_.size(); column += lanes / 2) {
    const FourFloats value = lanes_at<FourFloats>(refined_.data() + column),
                     difference = lanes_at<FourFloats>(shown_.data() + column) - value;
    const auto is_hidden = (difference > tolerance) | (difference < -tolerance);
    store(is_hidden ? FourFloats{} : value, refined_.data() + column);
  }
  std::copy_n(refined_.begin(), columns, disparity);
}

}  // namespace holdfast
