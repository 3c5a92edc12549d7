// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
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

TEST_P(KnownCamera, HasNoTroubleAndIsNotSuspicious) {
  const Camera camera = find_camera(GetParam()).value();
  EXPECT_EQ(camera.trouble(), "");
  EXPECT_EQ(camera.suspicions(true), std::vector<std::string>{});
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

TEST_P(AnyLens, HasNoTrouble) {
  EXPECT_EQ(GetParam().trouble(), "");
  EXPECT_EQ(GetParam().suspicions(true), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Lenses, AnyLens, testing::ValuesIn(lenses()));

/// A camera of 640x480 images.
Camera camera_of(double focal_length, const Distortion& distortion) {
  Camera camera;
  camera.fx = camera.fy = focal_length;
  camera.distortion = distortion;
  return camera;
}

/// A distortion without an inverse in the image, and about how far from the principal point it ends [px].
struct Fold {
  const char* cause;
  Camera camera;
  double radius;
};

std::vector<Fold> folds() {
  const double turn = std::sqrt(1.0 / 1.2);  // where 1 - 3 * 0.4 r^2 is 0
  Camera exchanged = find_camera("tum_fr1").value();
  std::swap(exchanged.distortion.k3, exchanged.distortion.p2);
  Camera fisheye_without_its_line = lenses()[0];  // k4 becomes a coefficient of the denominator
  fisheye_without_its_line.distortion.lens = Lens::radial_tangential;
  Camera folded_fisheye = camera_of(200, {.k1 = -0.4});
  folded_fisheye.distortion.lens = Lens::fisheye;
  return {{"strong barrel", camera_of(400, {.k1 = -0.4}), 400 * turn * (1.0 - 0.4 * turn * turn)},
          {"k3 and p2 exchanged", exchanged, 38},
          {"fisheye without its line", fisheye_without_its_line, 342},
          {"a wide lens, calibrated in the middle", camera_of(287, {.k1 = -0.26, .k2 = 0.08, .k3 = -0.012}), 306},
          {"a denominator of zero", camera_of(300, {.k4 = -0.2}), 1e9},
          {"k4 to k6 lost", camera_of(500, {.k1 = 0.515, .k2 = -2.61, .k3 = 1.505}), 281},
          {"fisheye that turns back", folded_fisheye, 200 * turn * (1.0 - 0.4 * turn * turn)}};
}

TEST(LensWithoutInverse, IsToldWithTheRadiusFromWhichItIsMissing) {
  for (const auto& [cause, camera, radius] : folds()) {
    if (radius > 1e6) continue;
    const std::string trouble = camera.trouble();
    const std::size_t end = trouble.find(" px from the principal point");
    ASSERT_NE(end, std::string::npos) << cause << ": " << trouble;
    EXPECT_NEAR(std::stod(trouble.substr(trouble.rfind(' ', end - 1))), radius, 1.5) << cause << ": " << trouble;
    EXPECT_NE(trouble.find("Usual causes"), std::string::npos) << trouble;
  }
}

/// Whatever the numbers are, the undistorted image is bounded, so that no table or grid over it is without end.
TEST(LensWithoutInverse, UndistortsIntoABoundedRegion) {
  for (const auto& [cause, camera, radius] : folds())
    for (int row = -8; row <= camera.height + 8; row += 12)
      for (int column = -8; column <= camera.width + 8; column += 12) {
        const Eigen::Vector2d pixel = camera.undistort({column, row});
        ASSERT_LT((pixel - Eigen::Vector2d(camera.cx, camera.cy)).norm(), 6.0 * camera.fx)
            << cause << " " << column << " " << row;
      }
}

/// The coefficients fit as long as the image ends before the radius turns back.
TEST(LensWithoutInverse, IsOneOnlyWhereTheImageReachesIt) {
  for (Fold fold : folds()) {
    if (fold.radius > 1e6) continue;
    Camera& camera = fold.camera;
    camera.width = camera.height = static_cast<int>(1.3 * fold.radius);  // half the diagonal: 0.92 of the radius
    camera.cx = camera.cy = 0.5 * (camera.width - 1);
    EXPECT_EQ(camera.trouble(), "") << fold.cause;
    for (int row = 0; row < camera.height; row += 5)
      for (int column = 0; column < camera.width; column += 5) {
        const Eigen::Vector2d raw(column, row);
        if (!camera.is_usable(raw)) continue;
        ASSERT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-3) << fold.cause << raw.transpose();
      }
  }
}

/// A pincushion so strong that the fixed-point iteration oscillates.
TEST(Camera, UndistortsWhereTheFixedPointIterationDiverges) {
  const Camera camera = camera_of(200, {.k1 = 0.3, .k2 = 1.0});
  ASSERT_EQ(camera.trouble(), "");
  for (int row = 0; row < camera.height; row += 7)
    for (int column = 0; column < camera.width; column += 7) {
      const Eigen::Vector2d raw(column, row);
      ASSERT_LT((camera.distort(camera.undistort(raw)) - raw).norm(), 1e-3) << raw.transpose();
    }
}

TEST(Camera, NumbersThatCannotBeAreTrouble) {
  EXPECT_EQ(Camera{}.trouble(), "");
  Camera camera;
  camera.fx = 0;
  EXPECT_NE(camera.trouble().find("expected width, height, fx and fy above 0"), std::string::npos);
  camera = Camera{};
  camera.distortion.k2 = std::nan("");
  EXPECT_NE(camera.trouble().find("no number"), std::string::npos);
  EXPECT_NE(camera_of(50, {.k1 = -1e-4}).trouble().find("80 degrees"), std::string::npos);
}

/// Suspicions of tum_fr1's camera, or another one, after a mistake.
std::string suspicion_of(const std::function<void(Camera&)>& mistake, const std::string& name = "tum_fr1") {
  Camera camera = find_camera(name).value();
  mistake(camera);
  std::string text;
  for (const std::string& suspicion : camera.suspicions(true)) text += suspicion + "\n";
  return text;
}

TEST(SuspiciousCamera, OfAnotherResolution) {
  const auto scaled = [](double factor) {
    return [factor](Camera& c) { c.fx *= factor, c.fy *= factor, c.cx *= factor, c.cy *= factor; };
  };
  EXPECT_THAT(suspicion_of(scaled(2.0)), testing::HasSubstr("multiply fx, fy, cx and cy by 0.48"));
  EXPECT_THAT(suspicion_of(scaled(0.5)), testing::HasSubstr("of about 330x248"));
  EXPECT_EQ(suspicion_of([](Camera& c) { c.height = 360, c.cy -= 60; }), "") << "cut out around the middle";
}

TEST(SuspiciousCamera, WhoseAxisIsOutsideTheImage) {
  EXPECT_THAT(suspicion_of([](Camera& c) { c.cx += 640; }), testing::HasSubstr("axis is at pixel (959, 255)"));
  EXPECT_THAT(suspicion_of([](Camera& c) { std::swap(c.cx, c.cy), c.cx = 0; }), testing::HasSubstr("check cx and cy"));
}

TEST(SuspiciousCamera, WhoseFocalLengthIsNotInPixels) {
  EXPECT_THAT(suspicion_of([](Camera& c) { c.fx = c.fy = 3.6; }), testing::HasSubstr("is it in millimetres"));
  EXPECT_THAT(suspicion_of([](Camera& c) { c.fx = c.fy = 5173; }), testing::HasSubstr("show 7 degrees"));
  EXPECT_THAT(suspicion_of([](Camera& c) { c.fy = 387; }), testing::HasSubstr("differ by a factor of 1.33"));
}

TEST(SuspiciousCamera, WhoseBaselineIsNotInMetres) {
  const auto baseline = [](double metres) { return suspicion_of([&](Camera& c) { c.baseline = metres; }, "kitti_00"); };
  EXPECT_THAT(baseline(537.1657), testing::HasSubstr("is it in millimetres, that is, 0.5372 m?"));
  EXPECT_THAT(baseline(53.7), testing::HasSubstr("in centimetres, that is, 0.537 m, or millimetres"));
  EXPECT_THAT(baseline(5e-4), testing::HasSubstr("the baseline is 0.0005 m"));
  for (const double metres : {0.0075, 0.05, 0.11, 0.54, 1.2, 2.5}) EXPECT_EQ(baseline(metres), "") << metres;
  Camera camera;
  camera.baseline = 537;
  EXPECT_TRUE(camera.suspicions(false).empty());
}

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
