// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <numeric>

#include "calibration/board_pictures.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

/// Mean distance of the corners found from where they are; a board that is numbered from its other end is turned first.
double mean_distance(const BoardView& found, const CalibrationBoard& board, const Camera& camera,
                     const Eigen::Isometry3d& pose) {
  double best = 1e9;
  for (const bool is_turned : {false, true}) {
    double sum = 0.0;
    for (std::size_t i = 0; i < found.corners.size(); ++i) {
      const int corner = is_turned ? board.corner_count() - 1 - found.corners[i] : found.corners[i];
      sum += (found.pixels[i] - camera.distort(camera.project(pose * board.corner(corner)))).norm();
    }
    best = std::min(best, sum / static_cast<double>(found.corners.size()));
  }
  return best;
}

TEST(BoardDetector, FindsAChessboardToAFractionOfAPixel) {
  const CalibrationBoard board;
  const Camera camera = test::usual_camera();
  const test::BoardCamera photographer(board, camera);
  const BoardDetector detector(board);
  for (const double tilt : {0.0, 0.5}) {
    const Eigen::Isometry3d pose = test::board_pose(board, {0.02, -0.01, 0.45}, tilt, 0.2);
    const BoardView found = detector.find(photographer.picture(pose));
    ASSERT_EQ(found.corners.size(), 54U);
    EXPECT_LT(mean_distance(found, board, camera, pose), 0.12);
  }
}

TEST(BoardDetector, FindsAPartOfABoardWithMarkers) {
  if (!has_charuco()) GTEST_SKIP() << "this build has no markers: OpenCV's module aruco is missing";
  CalibrationBoard board;
  board.pattern = BoardPattern::charuco;
  board.square = 0.03;
  const Camera camera = test::usual_camera();
  const test::BoardCamera photographer(board, camera);
  const BoardDetector detector(board);
  // The upper left part of the board is outside of the image.
  const Eigen::Isometry3d pose = test::board_pose(board, {-0.12, -0.06, 0.4}, 0.3, 0.1);
  const BoardView found = detector.find(photographer.picture(pose));
  EXPECT_GT(found.corners.size(), 20U);
  EXPECT_LT(found.corners.size(), 54U);
  EXPECT_TRUE(std::is_sorted(found.corners.begin(), found.corners.end()));
  double sum = 0.0;
  for (std::size_t i = 0; i < found.corners.size(); ++i)
    sum += (found.pixels[i] - camera.distort(camera.project(pose * board.corner(found.corners[i])))).norm();
  EXPECT_LT(sum / static_cast<double>(found.corners.size()), 0.2) << "numbered as printed";
}

TEST(BoardDetector, FindsNothingWhereThereIsNoBoard) {
  CalibrationBoard board;
  cv::Mat noise(240, 320, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 255);
  EXPECT_TRUE(BoardDetector(board).find(noise).corners.empty());
  // A board of another size is another board.
  const test::BoardCamera photographer(board, test::usual_camera());
  const cv::Mat picture = photographer.picture(test::board_pose(board, {0, 0, 0.45}, 0.2, 0.2));
  board.columns = 11;
  EXPECT_TRUE(BoardDetector(board).find(picture).corners.empty());
}

TEST(BoardSvg, HasItsTrueSize) {
  const CalibrationBoard board;
  const std::string svg = board_svg(board);
  // 10 by 7 squares of 25 mm and a margin of one more on each side.
  EXPECT_THAT(svg, HasSubstr("width=\"300.000mm\" height=\"225.000mm\" viewBox=\"0 0 300.000 225.000\""));
  EXPECT_THAT(svg, HasSubstr("squares of 25 mm"));
  EXPECT_THAT(svg, HasSubstr("250 mm wide"));
  const cv::Mat image = test::rasterised(svg, 1.0);
  EXPECT_EQ(cv::countNonZero(image == 0), 35 * 25 * 25);
}

TEST(BoardSvg, RefusesMoreMarkersThanThereAre) {
  if (!has_charuco()) GTEST_SKIP() << "this build has no markers: OpenCV's module aruco is missing";
  CalibrationBoard board;
  board.pattern = BoardPattern::charuco;
  board.columns = board.rows = 60;
  try {
    board_svg(board);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("1860 markers; expected at most 1000"));
  }
}

}  // namespace
}  // namespace holdfast
