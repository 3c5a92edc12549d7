// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/camera.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

namespace holdfast {
namespace {

class KnownCamera : public testing::TestWithParam<std::string> {};

TEST_P(KnownCamera, UndistortInvertsDistortOverTheWholeImage) {
  const Camera camera = find_camera(GetParam()).value();
  for (int row = 0; row < camera.height; row += 13)
    for (int column = 0; column < camera.width; column += 17) {
      const Eigen::Vector2d raw(column, row);
      const Eigen::Vector2d back = camera.distort(camera.undistort(raw));
      ASSERT_LT((back - raw).norm(), 1e-4) << column << " " << row;
    }
}

TEST_P(KnownCamera, BackProjectInvertsProject) {
  const Camera camera = find_camera(GetParam()).value();
  const Eigen::Vector3d point(0.3, -0.2, 1.7);
  const Eigen::Vector2d pixel = camera.project(point);
  EXPECT_TRUE(camera.back_project(pixel.x(), pixel.y(), 1.7).isApprox(point, 1e-12));
}

TEST_P(KnownCamera, BoundsHoldTheWholeImage) {
  const Camera camera = find_camera(GetParam()).value();
  Eigen::Vector2d minimum, maximum;
  camera.undistorted_bounds(minimum, maximum);
  for (int row = 0; row < camera.height; row += 7)
    for (int column = 0; column < camera.width; column += 7) {
      const Eigen::Vector2d pixel = camera.undistort({column, row});
      ASSERT_GE(pixel.x(), minimum.x() - 0.1);
      ASSERT_LE(pixel.x(), maximum.x() + 0.1);
      ASSERT_GE(pixel.y(), minimum.y() - 0.1);
      ASSERT_LE(pixel.y(), maximum.y() + 0.1);
    }
}

INSTANTIATE_TEST_SUITE_P(All, KnownCamera, testing::ValuesIn(camera_names()));

TEST(KnownCameras, KittiHasOneForEachCalibrationOfItsSequences) {
  // Rows of P1 in calib.txt of sequences 00, 03 and 04: fx, cx, cy, and -fx * baseline.
  const struct {
    const char* name;
    double fx, cx, cy, fx_baseline;
  } published[] = {{"kitti_00", 7.188560000000e+02, 6.071928000000e+02, 1.852157000000e+02, 3.861448000000e+02},
                   {"kitti_03", 7.215377000000e+02, 6.095593000000e+02, 1.728540000000e+02, 3.875744000000e+02},
                   {"kitti_04", 7.070912000000e+02, 6.018873000000e+02, 1.831104000000e+02, 3.798145000000e+02}};
  for (const auto& [name, fx, cx, cy, fx_baseline] : published) {
    const Camera camera = find_camera(name).value();
    EXPECT_EQ(camera.fx, fx) << name;
    EXPECT_EQ(camera.cx, cx) << name;
    EXPECT_EQ(camera.cy, cy) << name;
    EXPECT_NEAR(camera.fx * camera.baseline, fx_baseline, 1e-9) << name;
    EXPECT_TRUE(camera.distortion.is_zero()) << name;
  }
}

/// Lenses that find_camera() does not know: an action camera, a wide one, and a calibration with a denominator.
std::vector<Camera> lenses() {
  Camera fisheye;
  fisheye.width = 512, fisheye.height = 512;
  fisheye.fx = 190.978, fisheye.fy = 190.973, fisheye.cx = 254.932, fisheye.cy = 256.897;
  fisheye.distortion = {.k1 = 0.0034823894, .k2 = 0.0007150348, .k3 = -0.0020532361, .k4 = 0.000202936736};
  fisheye.distortion.lens = Lens::fisheye;
  Camera narrow;  // every pixel within the usable angle
  narrow.fx = 420, narrow.fy = 419;
  narrow.distortion = {.k1 = -0.03, .k2 = 0.01, .k3 = -0.02, .k4 = 0.004};
  narrow.distortion.lens = Lens::fisheye;
  Camera rational;
  rational.width = 1280, rational.height = 720;
  rational.fx = 608, rational.fy = 607.9, rational.cx = 638.1, rational.cy = 367.2;
  rational.distortion = {0.515, -2.61, 0.00068, -0.0002, 1.505, 0.394, -2.434, 1.4338};
  return {fisheye, narrow, rational};
}

cv::Mat matrix_of(const Camera& camera) {
  return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

class AnyLens : public testing::TestWithParam<Camera> {};

TEST_P(AnyLens, UndistortInvertsDistortWhereTheImageIsUsable) {
  const Camera& camera = GetParam();
  int usable = 0;
  for (int row = 0; row < camera.height; row += 13)
    for (int column = 0; column < camera.width; column += 17) {
      const Eigen::Vector2d raw(column, row);
      if (!camera.is_usable(raw)) continue;
      ++usable;
      ASSERT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-4) << column << " " << row;
    }
  EXPECT_GT(usable, 500);
}

TEST_P(AnyLens, ProjectsAsOpenCvDoes) {
  const Camera& camera = GetParam();
  std::vector<cv::Point3d> points;
  for (double y = -0.6; y < 0.61; y += 0.15)
    for (double x = -0.9; x < 0.91; x += 0.15) points.emplace_back(2.0 * x, 2.0 * y, 2.0);
  std::vector<cv::Point2d> expected, back;
  const cv::Vec3d zero(0, 0, 0);
  const std::vector<double> coefficients = camera.distortion.coefficients();
  if (camera.distortion.lens == Lens::fisheye) {
    cv::fisheye::projectPoints(points, expected, zero, zero, matrix_of(camera), coefficients);
    cv::fisheye::undistortPoints(expected, back, matrix_of(camera), coefficients, cv::noArray(), matrix_of(camera));
  } else {
    cv::projectPoints(points, zero, zero, matrix_of(camera), coefficients, expected);
    cv::undistortPoints(expected, back, matrix_of(camera), coefficients, cv::noArray(), matrix_of(camera),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel = camera.project({points[i].x, points[i].y, points[i].z});
    const Eigen::Vector2d raw = camera.distort(pixel), undistorted = camera.undistort({expected[i].x, expected[i].y});
    ASSERT_NEAR(raw.x(), expected[i].x, 1e-6);
    ASSERT_NEAR(raw.y(), expected[i].y, 1e-6);
    ASSERT_NEAR(undistorted.x(), back[i].x, 1e-3) << points[i];
    ASSERT_NEAR(undistorted.y(), back[i].y, 1e-3) << points[i];
    ASSERT_NEAR(undistorted.x(), pixel.x(), 1e-3) << points[i];
  }
}

TEST_P(AnyLens, BoundsHoldWhatIsUsable) {
  const Camera& camera = GetParam();
  Eigen::Vector2d minimum, maximum;
  camera.undistorted_bounds(minimum, maximum);
  for (int row = 0; row < camera.height; row += 7)
    for (int column = 0; column < camera.width; column += 7) {
      if (!camera.is_usable({column, row})) continue;
      const Eigen::Vector2d pixel = camera.undistort({column, row});
      ASSERT_TRUE((pixel.array() >= minimum.array() - 0.5).all() && (pixel.array() <= maximum.array() + 0.5).all());
    }
  // The image plane of a pinhole ends at 90 degrees; what a table holds of it ends before.
  EXPECT_LT((maximum - minimum).maxCoeff(), 2.0 * 2.2 * camera.fx + camera.width);
}

INSTANTIATE_TEST_SUITE_P(Lenses, AnyLens, testing::ValuesIn(lenses()));

TEST(FisheyeLens, IsUsableUpToItsAngle) {
  const Camera camera = lenses()[0];
  const auto at_angle = [&](double degrees) {
    const double angle = degrees * M_PI / 180.0;
    return camera.distort(camera.project({0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle)}));
  };
  EXPECT_TRUE(camera.is_usable({camera.cx, camera.cy}));
  EXPECT_TRUE(camera.is_usable(at_angle(59.9)));
  EXPECT_FALSE(camera.is_usable(at_angle(60.1)));
  EXPECT_FALSE(camera.is_usable({0, 0}));
  // Beyond 65 degrees there is the pixel at 65 degrees.
  const Eigen::Vector2d far = camera.undistort({0, 0}) - Eigen::Vector2d(camera.cx, camera.cy);
  EXPECT_NEAR(far.norm(), std::tan(65.0 * M_PI / 180.0) * camera.fx, 1.0);
  EXPECT_TRUE(Camera{}.is_usable({-100, -100}));
}

TEST(FisheyeLens, WithoutCoefficientsItIsStillNoPinhole) {
  Distortion distortion;
  EXPECT_TRUE(distortion.is_zero());
  distortion.lens = Lens::fisheye;
  EXPECT_FALSE(distortion.is_zero());
  EXPECT_EQ(distortion.coefficients().size(), 4U);
  EXPECT_EQ(distortion.trouble(), "");
  distortion.p1 = 0.1;
  EXPECT_NE(distortion.trouble().find("k1, k2, k3 and k4 alone"), std::string::npos);
}

TEST(RationalLens, HasEightCoefficients) {
  Distortion distortion{.k1 = 0.1};
  EXPECT_EQ(distortion.coefficients().size(), 5U);
  distortion.k6 = 0.1;
  EXPECT_EQ(distortion.coefficients(), (std::vector<double>{0.1, 0, 0, 0, 0, 0, 0, 0.1}));
}

TEST(Camera, UnknownNameIsNothing) { EXPECT_FALSE(find_camera("tum_fr4")); }

}  // namespace
}  // namespace holdfast
