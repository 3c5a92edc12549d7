// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/board_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "board_markers.hpp"
#include "holdfast/core/check.hpp"

namespace holdfast {

namespace {

/// Least distance of corners that are neighbours on the board [px].
double spacing_of(const BoardView& view, const CalibrationBoard& board) {
  double spacing = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < view.corners.size(); ++i)
    for (std::size_t k = i + 1; k < view.corners.size() && view.corners[k] <= view.corners[i] + board.columns; ++k) {
      const bool is_next = view.corners[k] == view.corners[i] + 1 && view.corners[k] % board.columns != 0;
      const bool is_below = view.corners[k] == view.corners[i] + board.columns;
      if (is_next || is_below) spacing = std::min(spacing, (view.pixels[k] - view.pixels[i]).norm());
    }
  return spacing;
}

/// Brings each corner to where the edges around it meet (Foerstner and Guelch 1987): what findChessboardCornersSB gives
/// is drawn towards pixels, the more the smaller the squares, and interpolateCornersCharuco of OpenCV 4.6 is half a
/// pixel off in both directions.
void refine(const cv::Mat& grey, const CalibrationBoard& board, BoardView& view) {
  if (view.corners.empty()) return;
  // A window that holds no other corner and no marker.
  const double share = board.pattern == BoardPattern::charuco ? 0.45 * (1.0 - board.marker) : 0.35;
  const double spacing = spacing_of(view, board);
  const int half = std::isfinite(spacing) ? std::clamp(static_cast<int>(share * spacing), 2, 10) : 2;
  std::vector<cv::Point2f> pixels;
  for (const Eigen::Vector2d& pixel : view.pixels)
    pixels.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  cv::cornerSubPix(grey, pixels, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3));
  for (std::size_t i = 0; i < pixels.size(); ++i) view.pixels[i] = {pixels[i].x, pixels[i].y};
}

BoardView find_chessboard(const cv::Mat& grey, const CalibrationBoard& board) {
  std::vector<cv::Point2f> pixels;
  // Duda and Frese 2018: a localised Radon transform, which finds boards in blur and noise.
  const int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;
  if (!cv::findChessboardCornersSB(grey, cv::Size(board.columns, board.rows), pixels, flags)) return {};
  BoardView view;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    view.corners.push_back(static_cast<int>(i));
    view.pixels.emplace_back(pixels[i].x, pixels[i].y);
  }
  return view;
}

}  // namespace

struct BoardDetector::Markers : BoardMarkers {
  using BoardMarkers::BoardMarkers;
};

BoardDetector::BoardDetector(const CalibrationBoard& board) : board_(board) {
  if (board.pattern == BoardPattern::charuco) markers_ = std::make_unique<Markers>(board);
}
BoardDetector::~BoardDetector() = default;
BoardDetector::BoardDetector(BoardDetector&&) noexcept = default;

BoardView BoardDetector::find(const cv::Mat& grey) const {
  HOLDFAST_CHECK(grey.type() == CV_8UC1, "type " << grey.type());
  BoardView view = markers_ ? markers_->find(grey) : find_chessboard(grey, board_);
  refine(grey, board_, view);
  return view;
}

}  // namespace holdfast
