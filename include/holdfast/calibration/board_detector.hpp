// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/calibration/calibration_board.hpp"

namespace holdfast {

/// The inner corners of a board that were found in one image.
struct BoardView {
  std::string name;                     ///< of the image
  std::vector<int> corners;             ///< indices on the board, ascending
  std::vector<Eigen::Vector2d> pixels;  ///< raw image position of each
};

/// Finds a board in images, to a fraction of a pixel. A chessboard is found as a whole or not at all; of a board with
/// markers, the corners next to them are found. A rotationally symmetric chessboard may be numbered from another end,
/// which does not affect calibration. Used by one thread.
class BoardDetector {
 public:
  /// Throws Error for a board with markers in a build without them, and for more markers than the dictionary has.
  explicit BoardDetector(const CalibrationBoard& board);
  ~BoardDetector();
  BoardDetector(BoardDetector&&) noexcept;

  /// The corners in an image 8UC1; none where the board is not found. The name is left empty.
  BoardView find(const cv::Mat& grey) const;

 private:
  CalibrationBoard board_;
  struct Markers;
  std::unique_ptr<Markers> markers_;  ///< of a board with markers
};

}  // namespace holdfast
