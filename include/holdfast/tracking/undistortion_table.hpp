// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Undistortion of pixels by a look-up table with bilinear interpolation between nodes every two pixels (error below
/// 0.005 px for the known cameras). Immutable after construction; any thread.
class UndistortionTable {
 public:
  explicit UndistortionTable(const Camera& camera);

  /// Undistorts positions inside the image; out_x and out_y may be x and y themselves.
  void undistort(const std::vector<float>& x, const std::vector<float>& y, std::vector<float>& out_x,
                 std::vector<float>& out_y) const;

 private:
  static constexpr int step = 2;  // px
  bool identity_;
  int columns_ = 0, rows_ = 0;
  std::vector<float> knots_;  // x, y by row and column
};

}  // namespace holdfast
