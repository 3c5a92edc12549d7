// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"

namespace holdfast {

/// A picture larger than the image, seen through a window that can be put anywhere.
class Picture {
 public:
  Picture() : texture_(700, 860, CV_32FC1, cv::Scalar(128)) {
    Random random(3);
    for (const int size : {6, 14, 40}) {
      cv::Mat noise(texture_.size(), CV_32FC1), smooth;
      for (int row = 0; row < noise.rows; ++row)
        for (int column = 0; column < noise.cols; ++column)
          noise.at<float>(row, column) = static_cast<float>(random.normal());
      cv::GaussianBlur(noise, smooth, cv::Size(), size * 0.5, size * 0.5);
      texture_ += smooth * (30.0 * size * 0.9);
    }
  }
  /// What was at (x, y) is at (x + shift_x, y + shift_y).
  cv::Mat seen(double shift_x, double shift_y) const {
    const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, shift_x - 100, 0, 1, shift_y - 100);
    cv::Mat image, grey;
    cv::warpAffine(texture_, image, move, cv::Size(640, 480), cv::INTER_CUBIC);
    image.convertTo(grey, CV_8U);
    return grey;
  }

 private:
  cv::Mat texture_;
};

}  // namespace holdfast
