// SPDX-License-Identifier: BSD-3-Clause
#include "second_look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/check.hpp"

namespace holdfast::unet_plugin {

namespace {

constexpr double share = 0.6;         // smallest part of the image's width and height that a second look shows
constexpr double least_gain = 1.15;   // by which the second look must enlarge the image
constexpr double least_doubt = 0.03;  // mean over the image from which on a second look pays
constexpr int search_step = 4;        // cells of the first look

int rounded(double value) { return static_cast<int>(std::lround(value)); }

/// Sizes of scores; their first dimension, which is 1, may be missing.
struct Shape {
  int classes, height, width;

  explicit Shape(const cv::Mat& scores)
      : classes(scores.size[scores.dims - 3]),
        height(scores.size[scores.dims - 2]),
        width(scores.size[scores.dims - 1]) {}
};

/// One class of scores as an image, which shares the memory. cv::Mat has no view of constant values: what is made of
/// constant scores must not be written to.
cv::Mat plane(const cv::Mat& scores, int channel) {
  const Shape shape(scores);
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(shape.height) * shape.width;
  return {shape.height, shape.width, CV_32F, const_cast<float*>(scores.ptr<float>()) + channel * size};
}

}  // namespace

void SecondLook::sum_doubts(const cv::Mat& scores, int person) {
  const Shape shape(scores);
  doubts_.create(shape.height, shape.width, CV_32F);
  const std::size_t cells = doubts_.total();
  const float* const score = scores.ptr<float>();
  float* const doubt = doubts_.ptr<float>();
  for (std::size_t cell = 0; cell < cells; ++cell) {
    float best_other = -1e30F;
    for (int channel = 0; channel < shape.classes; ++channel)
      if (channel != person) best_other = std::max(best_other, score[static_cast<std::size_t>(channel) * cells + cell]);
    // Like 4 p (1 - p) of the probability p, to 0.15, without an exponential function.
    const float half_lead = 0.5F * (score[static_cast<std::size_t>(person) * cells + cell] - best_other);
    const float square = half_lead * half_lead;
    doubt[cell] = 1.0F / (1.0F + square * square);
  }
  cv::integral(doubts_, sums_, CV_64F);
}

std::optional<cv::Rect> SecondLook::begin(const cv::Mat& scores, cv::Size image, cv::Size input, int person) {
  HOLDFAST_CHECK(scores.dims >= 3 && scores.type() == CV_32F && scores.isContinuous(), scores.dims);
  const auto [classes, height, width] = Shape(scores);
  HOLDFAST_CHECK(person < classes, person << " " << classes);
  // Cells of the second look in the whole image: not finer than the image's pixels allow.
  const int columns = rounded(std::min(width / share, static_cast<double>(width) * image.width / input.width));
  const int rows = rounded(std::min(height / share, static_cast<double>(height) * image.height / input.height));
  if (columns < least_gain * width || rows < least_gain * height) return std::nullopt;

  sum_doubts(scores, person);
  if (sums_.at<double>(height, width) < least_doubt * width * height) return std::nullopt;
  const int window_width = width * width / columns, window_height = height * height / rows;
  cv::Point best;
  double most = -1.0;
  for (int y = 0; y + window_height <= height; y += search_step)
    for (int x = 0; x + window_width <= width; x += search_step) {
      const int right = x + window_width, below = y + window_height;
      const double doubt = sums_.at<double>(below, right) - sums_.at<double>(y, right) - sums_.at<double>(below, x) +
                           sums_.at<double>(y, x);
      if (doubt > most) most = doubt, best = {x, y};
    }

  window_ = {std::min(rounded(static_cast<double>(best.x) * columns / width), columns - width),
             std::min(rounded(static_cast<double>(best.y) * rows / height), rows - height), width, height};
  const std::array<int, 4> size{1, classes, rows, columns};
  combined_.create(static_cast<int>(size.size()), size.data(), CV_32F);
  for (int channel = 0; channel < classes; ++channel) {
    cv::Mat to = plane(combined_, channel);
    cv::resize(plane(scores, channel), to, to.size(), 0, 0, cv::INTER_LINEAR);
  }
  const auto pixel_x = [&](int column) { return rounded(static_cast<double>(column) * image.width / columns); };
  const auto pixel_y = [&](int row) { return rounded(static_cast<double>(row) * image.height / rows); };
  const cv::Point corner(pixel_x(window_.x), pixel_y(window_.y));
  return cv::Rect(corner, cv::Point(pixel_x(window_.x + width), pixel_y(window_.y + height)));
}

const cv::Mat& SecondLook::combine(const cv::Mat& scores_of_window) {
  const auto [classes, height, width] = Shape(scores_of_window);
  HOLDFAST_CHECK(classes == Shape(combined_).classes && cv::Size(width, height) == window_.size(),
                 classes << " " << height << " " << width);
  for (int channel = 0; channel < classes; ++channel) {
    cv::Mat both = plane(combined_, channel)(window_);
    cv::addWeighted(both, 0.5, plane(scores_of_window, channel), 0.5, 0.0, both);
  }
  return combined_;
}

}  // namespace holdfast::unet_plugin
