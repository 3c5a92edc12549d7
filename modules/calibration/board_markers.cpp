// SPDX-License-Identifier: BSD-3-Clause
#include "board_markers.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"

#ifdef HOLDFAST_WITH_ARUCO
#include <opencv2/core/version.hpp>
// Version 4.7 moved the markers to another module, with another interface.
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#define HOLDFAST_ARUCO_IN_OBJDETECT
#include <opencv2/objdetect/aruco_dictionary.hpp>
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif
#endif

namespace holdfast {

const std::vector<std::string>& marker_dictionaries() {
  static const std::vector<std::string> names = {"4x4", "5x5", "6x6", "7x7"};
  return names;
}

#ifdef HOLDFAST_WITH_ARUCO

bool has_charuco() { return true; }

namespace {

/// OpenCV's number of the smallest dictionary of a kind with enough markers: the fewer there are, the less alike they
/// are.
int dictionary_for(const CalibrationBoard& board, int markers) {
  const auto& names = marker_dictionaries();
  const auto kind = std::find(names.begin(), names.end(), board.dictionary);
  if (kind == names.end()) throw Error("there is no dictionary '" + board.dictionary + "' of markers");
  // OpenCV lists 50, 100, 250 and 1000 markers for each number of cells, from 4x4 on.
  const int first = 4 * static_cast<int>(kind - names.begin());
  constexpr int sizes[] = {50, 100, 250, 1000};
  for (int i = 0; i < 4; ++i)
    if (markers <= sizes[i]) return first + i;
  throw Error("the board has " + std::to_string(markers) + " markers; expected at most 1000, those of a dictionary");
}

}  // namespace

#ifdef HOLDFAST_ARUCO_IN_OBJDETECT

struct BoardMarkers::Implementation {
  explicit Implementation(const CalibrationBoard& given)
      : dictionary(cv::aruco::getPredefinedDictionary(dictionary_for(given, squares_of(given).area() / 2))),
        board(squares_of(given), 1.0F, static_cast<float>(given.marker), dictionary) {
    // The board that earlier versions draw, whatever its number of rows is: one print serves all.
    board.setLegacyPattern(true);
    detector.setBoard(board);
  }
  static cv::Size squares_of(const CalibrationBoard& board) { return {board.columns + 1, board.rows + 1}; }

  void find(const cv::Mat& grey, std::vector<cv::Point2f>& pixels, std::vector<int>& corners) const {
    detector.detectBoard(grey, pixels, corners);
  }
  std::vector<std::vector<cv::Point3f>> outlines() const { return board.getObjPoints(); }
  cv::Mat marker(std::size_t k) const {
    cv::Mat image;
    dictionary.generateImageMarker(board.getIds()[k], dictionary.markerSize + 2, image, 1);
    return image;
  }

  cv::aruco::Dictionary dictionary;
  cv::aruco::CharucoBoard board;
  cv::aruco::CharucoDetector detector{board};
};

#else

struct BoardMarkers::Implementation {
  explicit Implementation(const CalibrationBoard& given)
      : squares(given.columns + 1, given.rows + 1),
        dictionary(cv::aruco::getPredefinedDictionary(dictionary_for(given, squares.area() / 2))),
        board(cv::aruco::CharucoBoard::create(squares.width, squares.height, 1.0F, static_cast<float>(given.marker),
                                              dictionary)),
        parameters(cv::aruco::DetectorParameters::create()) {}

  void find(const cv::Mat& grey, std::vector<cv::Point2f>& pixels, std::vector<int>& corners) const {
    std::vector<std::vector<cv::Point2f>> outlines;
    std::vector<int> markers;
    cv::aruco::detectMarkers(grey, dictionary, outlines, markers, parameters);
    if (!markers.empty()) cv::aruco::interpolateCornersCharuco(outlines, markers, grey, board, pixels, corners);
  }
  const std::vector<std::vector<cv::Point3f>>& outlines() const { return board->objPoints; }
  cv::Mat marker(std::size_t k) const {
    cv::Mat image;
    dictionary->drawMarker(board->ids[k], dictionary->markerSize + 2, image, 1);
    return image;
  }

  cv::Size squares;
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  cv::Ptr<cv::aruco::CharucoBoard> board;
  cv::Ptr<cv::aruco::DetectorParameters> parameters;
};

#endif

BoardMarkers::BoardMarkers(const CalibrationBoard& board) : implementation_(std::make_unique<Implementation>(board)) {}

BoardView BoardMarkers::find(const cv::Mat& grey) const {
  std::vector<cv::Point2f> pixels;
  std::vector<int> corners;
  implementation_->find(grey, pixels, corners);
  std::vector<std::pair<int, cv::Point2f>> found;
  for (std::size_t k = 0; k < corners.size(); ++k) found.emplace_back(corners[k], pixels[k]);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  BoardView view;
  for (const auto& [corner, pixel] : found) {
    view.corners.push_back(corner);
    view.pixels.emplace_back(pixel.x, pixel.y);
  }
  return view;
}

cv::Mat BoardMarkers::cells(int column, int row) const {
  // Asked of the board itself, whose markers stand in the white squares.
  const auto& outlines = implementation_->outlines();
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    cv::Point3f middle(0, 0, 0);
    for (const cv::Point3f& corner : outlines[k]) middle += corner * 0.25F;
    if (static_cast<int>(middle.x) == column && static_cast<int>(middle.y) == row) return implementation_->marker(k);
  }
  return {};
}

#else

bool has_charuco() { return false; }

struct BoardMarkers::Implementation {};

BoardMarkers::BoardMarkers(const CalibrationBoard&) {
  throw Error(
      "this build cannot work with boards with markers: they need OpenCV's module aruco before version 4.7, and "
      "objdetect from "
      "4.7 on (Debian: libopencv-contrib-dev); use a chessboard, or build Holdfast with it");
}
BoardView BoardMarkers::find(const cv::Mat&) const { return {}; }
cv::Mat BoardMarkers::cells(int, int) const { return {}; }

#endif

BoardMarkers::~BoardMarkers() = default;

}  // namespace holdfast
