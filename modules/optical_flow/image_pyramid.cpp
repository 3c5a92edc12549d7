// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/optical_flow/image_pyramid.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/check.hpp"

namespace holdfast {

namespace {

/// Fills the border of a padded level with its outermost pixels.
void fill_border(cv::Mat& padded) {
  constexpr int border = ImagePyramid::border;
  const int width = padded.cols - 2 * border, height = padded.rows - 2 * border;
  for (int row = border; row < border + height; ++row) {
    std::uint8_t* const pixels = padded.ptr(row);
    std::memset(pixels, pixels[border], border);
    std::memset(pixels + border + width, pixels[border + width - 1], border);
  }
  const auto whole_row = static_cast<std::size_t>(padded.cols);
  for (int row = 0; row < border; ++row) {
    std::memcpy(padded.ptr(row), padded.ptr(border), whole_row);
    std::memcpy(padded.ptr(border + height + row), padded.ptr(border + height - 1), whole_row);
  }
}

}  // namespace

void ImagePyramid::build(const cv::Mat& image) {
  HOLDFAST_CHECK(image.type() == CV_8UC1 || image.type() == CV_8UC3, "image type " << image.type());
  size_ = image.size();
  cv::Size size(size_.width / 2, size_.height / 2);
  for (std::size_t i = 0; i < levels; ++i, size = {(size.width + 1) / 2, (size.height + 1) / 2}) {
    cv::Mat& level = levels_[i];
    if (size.empty()) {
      level = cv::Mat();
      continue;
    }
    if (level.size() != size) {
      padded_[i].create(size.height + 2 * border, size.width + 2 * border, CV_8UC1);
      level = padded_[i](cv::Rect({border, border}, size));
    }
    if (i > 0)
      cv::pyrDown(levels_[i - 1], level, size);
    else
      take_half(image, level);
    fill_border(padded_[i]);
  }
}

void ImagePyramid::take_half(const cv::Mat& image, cv::Mat& half) {
  // Without the last column or row where their number is odd.
  const cv::Mat even = image(cv::Rect(0, 0, 2 * half.cols, 2 * half.rows));
  if (image.channels() == 1) {
    cv::resize(even, half, half.size(), 0, 0, cv::INTER_AREA);
    return;
  }
  cv::resize(even, half_colour_, half.size(), 0, 0, cv::INTER_AREA);
  cv::cvtColor(half_colour_, half, cv::COLOR_BGR2GRAY);
}

int corner_strength(const ImagePyramid& pyramid, int x, int y) {
  const cv::Mat& image = pyramid.level(0);
  if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) return 0;
  const auto stride = static_cast<std::ptrdiff_t>(image.step);
  const std::uint8_t* const at = image.ptr(y) + x;
  const auto pixel = [at, stride](int column, int row) { return static_cast<int>(at[row * stride + column]); };
  const int along_x =
      3 * (pixel(1, -1) - pixel(-1, -1) + pixel(1, 1) - pixel(-1, 1)) + 10 * (pixel(1, 0) - pixel(-1, 0));
  const int along_y =
      3 * (pixel(-1, 1) - pixel(-1, -1) + pixel(1, 1) - pixel(1, -1)) + 10 * (pixel(0, 1) - pixel(0, -1));
  return std::min(std::abs(along_x), std::abs(along_y));
}

}  // namespace holdfast
