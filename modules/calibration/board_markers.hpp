// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/calibration/board_detector.hpp"

namespace holdfast {

/// The markers of a board and how they are found; the only place that knows OpenCV's markers.
class BoardMarkers {
 public:
  /// Throws Error in a build without them, and for a board with more white squares than the dictionary has
  /// markers.
  explicit BoardMarkers(const CalibrationBoard& board);
  ~BoardMarkers();

  /// The corners next to markers in an image 8UC1.
  BoardView find(const cv::Mat& grey) const;
  /// The cells of the marker of a white square as 8UC1, 0 = black, with its black border; the squares are those of the
  /// whole board, counted row by row from 0. An empty image for a black square.
  cv::Mat cells(int column, int row) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace holdfast
