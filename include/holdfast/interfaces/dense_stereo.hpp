// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace holdfast {

/// Computes a disparity image of a rectified pair. Used by one thread.
class DenseStereo {
 public:
  virtual ~DenseStereo() = default;

  /// `left`, `right`: 8UC1, in which a point lies in the same row. `disparity`: 32FC1 of the same size, column in the
  /// left image minus column in the right one of what the left image shows [px]; 0 = none. Occluded pixels and those
  /// whose match is ambiguous should have none.
  virtual void match(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity) = 0;
};

}  // namespace holdfast
