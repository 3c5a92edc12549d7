// SPDX-License-Identifier: BSD-3-Clause
#include "board_markers.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"

#ifdef HOLDFAST_WITH_ARUCO
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif

namespace holdfast {

const std::vector<std::string>& marker_dictionaries() {
  static const std::vector<std::string> names = {"4x4", "5x5", "6x6", "7x7"};
  return names;
}

#ifdef HOLDFAST_WITH_ARUCO

bool has_charuco() { return true; }

namespace {

/// The smallest dictionary of a kind with enough markers: the fewer there are, the less alike they are.
cv::Ptr<cv::aruco::Dictionary> dictionary_for(const CalibrationBoard& board, int markers) {
  const auto& names = marker_dictionaries();
  const auto kind = std::find(names.begin(), names.end(), board.dictionary);
  if (kind == names.end()) throw Error("there is no dictionary '" + board.dictionary + "' of markers");
  // OpenCV lists 50, 100, 250 and 1000 markers for each number of cells, from 4x4 on.
  const int first = 4 * static_cast<int>(kind - names.begin());
  constexpr int sizes[] = {50, 100, 250, 1000};
  for (int i = 0; i < 4; ++i)
    if (markers <= sizes[i]) return cv::aruco::getPredefinedDictionary(first + i);
  throw Error("the board has " + std::to_string(markers) + " markers; expected at most 1000, those of a dictionary");
}

}  // namespace

struct BoardMarkers::Implementation {
  explicit Implementation(const CalibrationBoard& board)
      : squares(board.columns + 1, board.rows + 1),
        dictionary(dictionary_for(board, squares.area() / 2)),
        charuco(cv::aruco::CharucoBoard::create(squares.width, squares.height, 1.0F, static_cast<float>(board.marker),
                                                dictionary)),
        parameters(cv::aruco::DetectorParameters::create()) {}

  cv::Size squares;
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  cv::Ptr<cv::aruco::CharucoBoard> charuco;
  cv::Ptr<cv::aruco::DetectorParameters> parameters;
};

BoardMarkers::BoardMarkers(const CalibrationBoard& board) : implementation_(std::make_unique<Implementation>(board)) {}

BoardView BoardMarkers::find(const cv::Mat& grey) const {
  const Implementation& i = *implementation_;
  std::vector<std::vector<cv::Point2f>> outlines;
  std::vector<int> markers;
  cv::aruco::detectMarkers(grey, i.dictionary, outlines, markers, i.parameters);
  if (markers.empty()) return {};
  std::vector<cv::Point2f> pixels;
  std::vector<int> corners;
  cv::aruco::interpolateCornersCharuco(outlines, markers, grey, i.charuco, pixels, corners);
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
  const Implementation& i = *implementation_;
  // Asked of the board itself, whose markers stand in the white squares.
  for (std::size_t k = 0; k < i.charuco->objPoints.size(); ++k) {
    cv::Point3f middle(0, 0, 0);
    for (const cv::Point3f& corner : i.charuco->objPoints[k]) middle += corner * 0.25F;
    if (static_cast<int>(middle.x) != column || static_cast<int>(middle.y) != row) continue;
    cv::Mat image;
    i.dictionary->drawMarker(i.charuco->ids[k], i.dictionary->markerSize + 2, image, 1);
    return image;
  }
  return {};
}

#else

bool has_charuco() { return false; }

struct BoardMarkers::Implementation {};

BoardMarkers::BoardMarkers(const CalibrationBoard&) {
  throw Error(
      "this build cannot work with boards with markers: they need OpenCV's module aruco, version 4.5 or 4.6 (Debian: "
      "libopencv-contrib-dev); use a chessboard, or build Holdfast with it");
}
BoardView BoardMarkers::find(const cv::Mat&) const { return {}; }
cv::Mat BoardMarkers::cells(int, int) const { return {}; }

#endif

BoardMarkers::~BoardMarkers() = default;

}  // namespace holdfast
