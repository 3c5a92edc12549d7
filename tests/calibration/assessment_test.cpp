// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/assessment.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "calibration/board_pictures.hpp"
#include "holdfast/calibration/calibration_output.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Calibration calibrated(const std::vector<Eigen::Isometry3d>& poses, const Camera& camera) {
  const CalibrationBoard board;
  Random random(5);
  std::vector<BoardView> views;
  for (const Eigen::Isometry3d& pose : poses) {
    views.push_back(test::exact_view(board, camera, pose, 0.1, &random));
    views.back().name = "view_" + std::to_string(views.size() - 1) + ".png";
  }
  return calibrate(views, board, camera.width, camera.height, {});
}

std::vector<Eigen::Isometry3d> usual_poses(double tilt) {
  return test::board_poses(CalibrationBoard(), test::usual_camera(), 0.4, tilt, 0.3);
}

TEST(Assess, IsContentWithViewsFromAllSides) {
  const CalibrationAssessment assessment = assess(calibrated(usual_poses(35.0 * test::degree), test::usual_camera()));
  EXPECT_EQ(assessment.trouble, "");
  EXPECT_THAT(assessment.advice, IsEmpty());
  EXPECT_GT(assessment.coverage, 0.7);
  EXPECT_GT(assessment.reach, 0.85);
  EXPECT_NEAR(assessment.largest_tilt / test::degree, 35.0, 3.0);
}

TEST(Assess, NamesViewsThatAreAllFrontal) {
  const CalibrationAssessment assessment = assess(calibrated(usual_poses(0.0), test::usual_camera()));
  EXPECT_THAT(assessment.trouble, AllOf(HasSubstr("from the front"), HasSubstr("view_0.png, view_1.png"),
                                        HasSubstr("and 10 more"), HasSubstr("turned by 20 to 45 degrees")));
}

TEST(Assess, AdvisesWhatToPhotographNext) {
  const CalibrationBoard board;
  std::vector<Eigen::Isometry3d> poses;
  // All on the left, and turned around the vertical axis alone.
  for (const double tilt : {-0.6, -0.4, 0.4, 0.6})
    poses.push_back(test::board_pose(board, {-0.12, 0.0, 0.5}, tilt, 0.0));
  const CalibrationAssessment assessment = assess(calibrated(poses, test::usual_camera()));
  EXPECT_THAT(assessment.advice, Contains(AllOf(HasSubstr("without corners"), HasSubstr("right edge"),
                                                HasSubstr("lower right corner"), Not(HasSubstr("left edge")))));
  EXPECT_THAT(assessment.advice, Contains(HasSubstr("lean the board forwards and backwards")));
  EXPECT_THAT(assessment.advice, Not(Contains(HasSubstr("turn the board to the left"))));
  EXPECT_THAT(assessment.advice, Contains(HasSubstr("take 6 more pictures")));
}

TEST(CalibrationOutput, SaysTheSameToPeopleAndPrograms) {
  const Calibration calibration = calibrated(usual_poses(35.0 * test::degree), test::usual_camera());
  const CalibrationAssessment assessment = assess(calibration);
  const std::string text = to_text(calibration, assessment);
  EXPECT_THAT(text, AllOf(HasSubstr("18 views, 18 used; images 640x480, lens radial_tangential"),
                          HasSubstr("reprojection error 0.1"), HasSubstr("  fx        51"), HasSubstr("view_17.png")));
  const auto json = nlohmann::json::parse(to_json(calibration, assessment, CalibrationBoard()));
  EXPECT_NEAR(json.at("camera").at("fx").get<double>(), 517.3, 1.0);
  EXPECT_EQ(json.at("camera").at("lens"), "radial_tangential");
  EXPECT_GT(json.at("standard_deviations").at("fx").get<double>(), 0.0);
  EXPECT_EQ(json.at("views").size(), 18U);
  EXPECT_TRUE(json.at("trouble").is_null());
  EXPECT_THAT(camera_yaml(calibration, CalibrationBoard()),
              AllOf(HasSubstr("camera:\n  width: 640\n  height: 480\n  fx: 51"),
                    HasSubstr("\n  lens: radial_tangential\n  k1: 0.1")));
}

TEST(CalibrationOutput, DrawsCoverageAndResiduals) {
  const Calibration calibration = calibrated(usual_poses(35.0 * test::degree), test::usual_camera());
  const cv::Mat picture = calibration_plot(calibration, assess(calibration));
  EXPECT_EQ(picture.type(), CV_8UC3);
  cv::Mat changed;
  cv::inRange(picture, cv::Scalar::all(0), cv::Scalar::all(250), changed);
  EXPECT_GT(cv::countNonZero(changed), 20000);
}

}  // namespace
}  // namespace holdfast
