// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/calibration/calibration.hpp"

#include <gmock/gmock.h>

#include "calibration/board_pictures.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

constexpr double deviations_allowed = 4.0;

std::vector<BoardView> exact_views(const CalibrationBoard& board, const Camera& camera, double distance,
                                   double spread = 0.22, double noise = 0.0) {
  Random random(11);
  std::vector<BoardView> views;
  for (const Eigen::Isometry3d& pose : test::board_poses(board, camera, distance, 35.0 * test::degree, spread)) {
    views.push_back(test::exact_view(board, camera, pose, noise, noise > 0.0 ? &random : nullptr));
    views.back().name = "view " + std::to_string(views.size() - 1);
  }
  return views;
}

CalibrationOptions options_for(Lens lens) {
  CalibrationOptions options;
  options.lens = lens;
  return options;
}

/// Largest distance of the image positions of rays by two cameras, over the image.
double largest_difference(const Camera& a, const Camera& b) {
  double largest = 0.0;
  for (int y = 0; y < a.height; y += 40)
    for (int x = 0; x < a.width; x += 40) {
      const Eigen::Vector2d raw(x, y);
      if (!a.is_usable(raw)) continue;
      const Eigen::Vector2d pixel = a.undistort(raw);
      const Eigen::Vector3d ray((pixel.x() - a.cx) / a.fx, (pixel.y() - a.cy) / a.fy, 1.0);
      largest = std::max(largest, (b.distort(b.project(ray)) - a.distort(a.project(ray))).norm());
    }
  return largest;
}

TEST(Calibrate, RecoversEveryLensFromExactCorners) {
  const CalibrationBoard board;
  Camera rational = test::usual_camera();
  rational.distortion = {
      .k1 = 0.3, .k2 = -0.1, .p1 = 0.001, .p2 = -0.001, .k3 = 0.05, .k4 = 0.2, .k5 = -0.15, .k6 = 0.04};
  Camera telephoto = test::usual_camera();
  telephoto.fx = telephoto.fy = 1500.0;
  const std::tuple<Camera, double, int, double> cases[] = {{test::usual_camera(), 0.5, 5, 1e-4},
                                                           {telephoto, 1.3, 5, 1e-3},
                                                           {rational, 0.5, 8, 1e-3},
                                                           {test::wide_camera(), 0.25, 5, 1e-3}};
  for (const auto& [camera, distance, coefficients, tolerance] : cases) {
    CalibrationOptions options = options_for(camera.distortion.lens);
    options.coefficients = coefficients;
    const Calibration found =
        calibrate(exact_views(board, camera, distance), board, camera.width, camera.height, options);
    EXPECT_LT(found.rms, 1e-5) << camera.fx;
    EXPECT_NEAR(found.camera.fx, camera.fx, tolerance);
    EXPECT_NEAR(found.camera.fy, camera.fy, tolerance);
    EXPECT_NEAR(found.camera.cx, camera.cx, tolerance);
    EXPECT_NEAR(found.camera.cy, camera.cy, tolerance);
    EXPECT_LT(largest_difference(camera, found.camera), 10.0 * tolerance) << camera.fx;
    EXPECT_EQ(found.used_count(), 18U);
  }
}

TEST(Calibrate, KnowsItsUncertainty) {
  const CalibrationBoard board;
  for (const Camera& camera : {test::usual_camera(), test::wide_camera()}) {
    const double distance = camera.distortion.lens == Lens::fisheye ? 0.25 : 0.5;
    const Calibration found = calibrate(exact_views(board, camera, distance, 0.22, 0.2), board, camera.width,
                                        camera.height, options_for(camera.distortion.lens));
    EXPECT_NEAR(found.rms, 0.2 * std::sqrt(2.0), 0.02);
    const std::pair<const char*, double> truth[] = {
        {"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx}, {"cy", camera.cy}, {"k1", camera.distortion.k1}};
    for (const auto& [name, value] : truth) {
      const CalibratedNumber& number = found.number(name);
      EXPECT_LT(std::abs(number.value - value), deviations_allowed * number.standard_deviation) << name;
      EXPECT_LT(number.standard_deviation, 0.01 * camera.fx) << name;
    }
    EXPECT_GT(found.number("fx").standard_deviation, 0.01) << "not better than the corners allow";
  }
}

TEST(Calibrate, RecoversTheLensFromPictures) {
  const CalibrationBoard board;
  const std::tuple<Camera, double, double> cases[] = {{test::usual_camera(), 0.5, 0.22},
                                                      {test::wide_camera(), 0.28, 0.3}};
  for (const auto& [camera, distance, spread] : cases) {
    const test::BoardCamera photographer(board, camera);
    const BoardDetector detector(board);
    std::vector<BoardView> views;
    for (const Eigen::Isometry3d& pose : test::board_poses(board, camera, distance, 30.0 * test::degree, spread)) {
      BoardView view = detector.find(photographer.picture(pose, views.size() + 1));
      if (!view.corners.empty()) views.push_back(std::move(view));
    }
    ASSERT_GE(views.size(), 12U);
    const Calibration found = calibrate(views, board, camera.width, camera.height, options_for(camera.distortion.lens));
    EXPECT_LT(found.rms, 0.12);
    EXPECT_NEAR(found.camera.fx, camera.fx, 0.002 * camera.fx);
    EXPECT_NEAR(found.camera.fy, camera.fy, 0.002 * camera.fy);
    EXPECT_NEAR(found.camera.cx, camera.cx, 1.0);
    EXPECT_NEAR(found.camera.cy, camera.cy, 1.0);
    EXPECT_NEAR(found.camera.distortion.k1, camera.distortion.k1, 0.02);
  }
}

TEST(Calibrate, LeavesOutViewsThatDisagree) {
  const CalibrationBoard board;
  const Camera camera = test::usual_camera();
  std::vector<BoardView> views = exact_views(board, camera, 0.5, 0.22, 0.1);
  // A bent board: its right half leans back.
  for (std::size_t i = 0; i < views[3].pixels.size(); ++i)
    if (views[3].corners[i] % board.columns > 4)
      views[3].pixels[i].y() += 3.0 * (views[3].corners[i] % board.columns - 4);
  Calibration found = calibrate(views, board, camera.width, camera.height, {});
  EXPECT_FALSE(found.views[3].is_used);
  EXPECT_EQ(found.used_count(), 17U);
  EXPECT_NEAR(found.camera.fx, camera.fx, 1.0);
  EXPECT_GT(found.views[3].rms, 1.0);

  CalibrationOptions options;
  options.keep_all_views = true;
  found = calibrate(views, board, camera.width, camera.height, options);
  EXPECT_EQ(found.used_count(), 18U);
  EXPECT_GT(found.rms, 0.5);
}

TEST(Calibrate, IsTheSameTwice) {
  const CalibrationBoard board;
  const Camera camera = test::usual_camera();
  const std::vector<BoardView> views = exact_views(board, camera, 0.5, 0.22, 0.1);
  const Camera first = calibrate(views, board, camera.width, camera.height, {}).camera;
  EXPECT_EQ(first, calibrate(views, board, camera.width, camera.height, {}).camera);
}

TEST(Calibrate, NeedsThreeViews) {
  const CalibrationBoard board;
  const Camera camera = test::usual_camera();
  std::vector<BoardView> views = exact_views(board, camera, 0.5);
  views.resize(2);
  views.push_back({"with three corners", {0, 1, 2}, {{1, 1}, {2, 2}, {3, 3}}});
  try {
    calibrate(views, board, camera.width, camera.height, {});
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("found 2 views with six corners or more; expected at least 3"));
  }
}

}  // namespace
}  // namespace holdfast
