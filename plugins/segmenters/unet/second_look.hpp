// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace holdfast::unet_plugin {

/// A second look of a network at the part of an image in which its first look was least certain. The first look shrinks
/// the image to the input of the network, in which people who are far away are few pixels; the second one shows a part
/// of the image at up to 5/3 of that size. One thread; keeps its buffers.
///
/// Scores are classes x height x width, 32F and contiguous, before softmax; a dimension of 1 may precede. The result
/// has more cells than the scores of the first look: a cell covers as many pixels as one of the second look.
class SecondLook {
 public:
  /// Resizes the scores of the first look at an image to the size of cells of the second look, and returns the pixels
  /// that deserve one: the part of the image with the largest sum of doubts whether there is a person. Nothing if the
  /// image has no more detail than the first look has seen, or if there is little doubt anywhere. `input`: size of the
  /// network's input [px]; `person`: channel of the class.
  std::optional<cv::Rect> begin(const cv::Mat& scores, cv::Size image, cv::Size input, int person);

  /// After begin() has named pixels: the mean of both looks in the window, given the scores of the second look at these
  /// pixels; elsewhere the first look. Valid until the next call.
  const cv::Mat& combine(const cv::Mat& scores_of_window);

 private:
  /// Fills sums_ with the doubts of the cells.
  void sum_doubts(const cv::Mat& scores, int person);

  cv::Mat doubts_;    // 32F, of each cell of the first look
  cv::Mat sums_;      // 64F, their cv::integral()
  cv::Mat combined_;  // scores of the image, in cells of the second look
  cv::Rect window_;   // of combined_ that the second look shows
};

}  // namespace holdfast::unet_plugin
