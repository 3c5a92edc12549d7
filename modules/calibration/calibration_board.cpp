// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/calibration_board.hpp"

#include "board_markers.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

const std::vector<std::string>& board_pattern_names() {
  static const std::vector<std::string> names = {"chessboard", "charuco"};
  return names;
}

const char* board_pattern_name(BoardPattern pattern) {
  return board_pattern_names()[static_cast<std::size_t>(pattern)].c_str();
}

std::optional<BoardPattern> find_board_pattern(const std::string& name) {
  for (const BoardPattern pattern : {BoardPattern::chessboard, BoardPattern::charuco})
    if (name == board_pattern_name(pattern)) return pattern;
  return std::nullopt;
}

namespace {

/// Black rectangles in millimetres, as one path: without seams between neighbours.
class BlackRectangles {
 public:
  void add(double x, double y, double width, double height) {
    path_ +=
        'M' + number(x) + ' ' + number(y) + 'h' + number(width) + 'v' + number(height) + 'h' + number(-width) + 'z';
  }
  std::string svg() const { return "<path shape-rendering=\"crispEdges\" d=\"" + path_ + "\"/>\n"; }

 private:
  static std::string number(double value) { return fixed_text(value, 4); }
  std::string path_;
};

void add_marker(const cv::Mat& cells, double x, double y, double size, BlackRectangles& black) {
  const double cell = size / cells.cols;
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) {
      if (cells.at<std::uint8_t>(row, column) != 0) continue;
      int end = column;
      while (end < cells.cols && cells.at<std::uint8_t>(row, end) == 0) ++end;
      black.add(x + column * cell, y + row * cell, (end - column) * cell, cell);
      column = end;
    }
  }
}

/// Whether the square in that place is black. The first square of a chessboard is; of OpenCV's boards with markers too,
/// whose markers stand in the white ones.
bool is_black(int column, int row) { return (column + row) % 2 == 0; }

}  // namespace

std::string board_svg(const CalibrationBoard& board) {
  const double square = 1e3 * board.square, margin = square;
  const int columns = board.columns + 1, rows = board.rows + 1;
  const double width = columns * square + 2.0 * margin, height = rows * square + 2.0 * margin;
  const std::string size = "width=\"" + fixed_text(width, 3) + "mm\" height=\"" + fixed_text(height, 3) + "mm\"";
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" " + size + " viewBox=\"0 0 " + fixed_text(width, 3) +
                    ' ' + fixed_text(height, 3) + "\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  BlackRectangles black;
  std::unique_ptr<BoardMarkers> markers;
  if (board.pattern == BoardPattern::charuco) markers = std::make_unique<BoardMarkers>(board);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = margin + column * square, y = margin + row * square;
      const cv::Mat cells = markers ? markers->cells(column, row) : cv::Mat();
      const double border = 0.5 * square * (1.0 - board.marker);
      if (!cells.empty())
        add_marker(cells, x + border, y + border, square * board.marker, black);
      else if (markers || is_black(column, row))
        black.add(x, y, square, square);
    }
  }
  svg += black.svg();
  const std::string what = std::string(board_pattern_name(board.pattern)) + " " + std::to_string(board.columns) + "x" +
                           std::to_string(board.rows) + ", squares of " + shortest_text(square) +
                           " mm. Print at 100 % and measure: all squares in a row are " +
                           shortest_text(columns * square) + " mm wide.";
  svg += "<text x=\"" + fixed_text(margin, 3) + "\" y=\"" + fixed_text(height - 0.3 * margin, 3) +
         "\" font-family=\"sans-serif\" font-size=\"" + fixed_text(std::min(4.0, columns * square / 60.0), 2) +
         "\" fill=\"#555\">" + what + "</text>\n</svg>\n";
  return svg;
}

}  // namespace holdfast
