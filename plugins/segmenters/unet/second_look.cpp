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

/// One class of scores as an image, which shares the memory. cv::Mat has no view of constant values: what is made of
/// constant scores must not be written to.
cv::Mat plane(const cv::Mat& scores, int channel) {
  const int height = scores.size[2], width = scores.size[3];
  return {height, width, CV_32F, const_cast<float*>(scores.ptr<float>(0, channel))};
}

}  // namespace

void SecondLook::sum_doubts(const cv::Mat& scores, int person) {
  const int classes = scores.size[1], height = scores.size[2], width = scores.size[3];
  sums_.create(height + 1, width + 1, CV_64F);
  sums_.row(0).setTo(0.0);
  for (int y = 0; y < height; ++y) {
    const double* const above = sums_.ptr<double>(y);
    double* const sums = sums_.ptr<double>(y + 1);
    double of_row = 0.0;
    sums[0] = 0.0;
    for (int x = 0; x < width; ++x) {
      float best_other = -1e30F;
      for (int channel = 0; channel < classes; ++channel)
        if (channel != person) best_other = std::max(best_other, scores.ptr<float>(0, channel, y)[x]);
      // Like 4 p (1 - p) of the probability p, to 0.15, without an exponential function.
      const float half_lead = 0.5F * (scores.ptr<float>(0, person, y)[x] - best_other);
      const float square = half_lead * half_lead;
      of_row += static_cast<double>(1.0F / (1.0F + square * square));
      sums[x + 1] = above[x + 1] + of_row;
    }
  }
}

std::optional<cv::Rect> SecondLook::begin(const cv::Mat& scores, cv::Size image, cv::Size input, int person) {
  HOLDFAST_CHECK(scores.dims == 4 && scores.type() == CV_32F && person < scores.size[1], scores.dims);
  const int classes = scores.size[1], height = scores.size[2], width = scores.size[3];
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
  HOLDFAST_CHECK(scores_of_window.dims == 4 && scores_of_window.size[1] == combined_.size[1] &&
                     scores_of_window.size[2] == window_.height && scores_of_window.size[3] == window_.width,
                 scores_of_window.dims);
  for (int channel = 0; channel < combined_.size[1]; ++channel) {
    const cv::Mat second = plane(scores_of_window, channel);
    cv::Mat first = plane(combined_, channel)(window_);
    for (int y = 0; y < window_.height; ++y) {
      const float* const from = second.ptr<float>(y);
      float* const to = first.ptr<float>(y);
      for (int x = 0; x < window_.width; ++x) to[x] = 0.5F * (to[x] + from[x]);
    }
  }
  return combined_;
}

}  // namespace holdfast::unet_plugin
