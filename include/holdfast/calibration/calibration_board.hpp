// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace holdfast {

/// Pattern of a board.
enum class BoardPattern {
  chessboard,  ///< black and white squares; the whole board must be in the picture
  charuco,     ///< with a marker in each white square (Garrido-Jurado et al. 2014), so that a part of it is enough
};

/// chessboard or charuco.
const char* board_pattern_name(BoardPattern pattern);
const std::vector<std::string>& board_pattern_names();
std::optional<BoardPattern> find_board_pattern(const std::string& name);

/// A flat board with a regular pattern, photographed to calibrate a camera. Board frame: origin at the first inner
/// corner, x along the rows, y along the columns, z = 0 [m].
struct CalibrationBoard {
  BoardPattern pattern = BoardPattern::chessboard;
  int columns = 9;                 ///< inner corners in a row: where four squares meet; at least 2
  int rows = 6;                    ///< inner corners in a column
  double square = 0.025;           ///< length of the side of a square [m]
  double marker = 0.75;            ///< length of the side of a marker, as a share of that of a square, 0.3 to 0.9
  std::string dictionary = "5x5";  ///< of the markers: one of marker_dictionaries()

  int corner_count() const { return columns * rows; }
  /// Position of an inner corner in the board frame; corners are counted row by row.
  Eigen::Vector3d corner(int index) const { return {index % columns * square, index / columns * square, 0.0}; }
};

/// Names of the dictionaries of markers: "4x4" to "7x7", the number of cells of a marker.
const std::vector<std::string>& marker_dictionaries();

/// Whether this build finds boards with markers; they need OpenCV's module aruco, or objdetect from version 4.7 on.
bool has_charuco();

/// The board as an SVG picture in millimetres, with a white margin and a line with its description and dimensions.
/// Throws Error for a board with markers in a build that has none, and for one with more of them than the dictionary.
std::string board_svg(const CalibrationBoard& board);

}  // namespace holdfast
