// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace holdfast {

/// Grey image pyramid from half the resolution, for follow_points(). The first level contains means of 2 x 2 pixels:
/// column x of the image corresponds to 0.5 * x - 0.25 (integers at pixel centres). Each further level is smoothed and
/// subsampled by two: x corresponds to 0.5 * x. Keeps its buffers. One thread.
class ImagePyramid {
 public:
  static constexpr int levels = 3;
  /// Width of the replicated border around each level [px].
  static constexpr int border = 8;

  /// `image` is 8UC1 or 8UC3 (BGR). All levels of an image without two rows and columns are empty.
  void build(const cv::Mat& image);
  bool empty() const { return size_.empty(); }
  /// Of the image [px].
  cv::Size size() const { return size_; }
  /// 8UC1; pixels up to `border` outside may be read.
  const cv::Mat& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }

 private:
  void take_half(const cv::Mat& image, cv::Mat& half);

  cv::Size size_;
  cv::Mat half_colour_;
  std::array<cv::Mat, levels> padded_, levels_;  // the second are windows into the first
};

/// Corner strength at a pixel of the first level: the smaller magnitude of the two derivatives by Scharr's filter (32
/// times grey levels per pixel). 0 outside the image.
int corner_strength(const ImagePyramid& pyramid, int x, int y);

}  // namespace holdfast
