// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/stereo_rectification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "support/raw_pair.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

Camera rendered_camera() {
  Camera camera;
  camera.width = 900, camera.height = 700;
  camera.fx = camera.fy = 380, camera.cx = 449.5, camera.cy = 349.5;
  camera.baseline = 0.11;
  return camera;
}

class AnyPair : public testing::TestWithParam<Camera> {
 protected:
  test::RawPair pair_{rendered_camera(), GetParam()};
  StereoRectification rectification_{pair_.calibration()};
};

TEST_P(AnyPair, PointsLieInOneRowTheirDisparityApart) {
  const StereoCameras& raw = pair_.calibration();
  const Camera& camera = rectification_.camera();
  EXPECT_TRUE(camera.distortion.is_zero());
  EXPECT_NEAR(camera.baseline, 0.11, 1e-12);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d left{random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(1.0, 4.0)};
    const Eigen::Vector3d right = raw.T_left_right.inverse() * left;
    const auto in = [](const Eigen::Isometry3d& T_raw_rectified, const Eigen::Vector3d& point) -> Eigen::Vector3d {
      return T_raw_rectified.inverse() * point;
    };
    const Eigen::Vector3d rectified = in(rectification_.T_left_rectified(), left);
    const Eigen::Vector2d a = camera.project(rectified);
    const Eigen::Vector2d b = camera.project(in(rectification_.T_right_rectified(), right));
    ASSERT_NEAR(a.y(), b.y(), 1e-9);
    ASSERT_NEAR(b.x(), camera.right_x(a.x(), rectified.z()), 1e-9);
  }
}

TEST_P(AnyPair, EveryPixelShowsWhatBothCamerasSee) {
  const cv::Mat white(GetParam().height, GetParam().width, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(rectification_.rectify_left(white) < 250), 0);
  EXPECT_EQ(cv::countNonZero(rectification_.rectify_right(white) < 250), 0);
  // And not much less: the image is no enlarged detail.
  EXPECT_GT(rectification_.camera().fx, 0.8 * GetParam().fx);
  EXPECT_LT(rectification_.camera().fx, 1.6 * GetParam().fx);
}

TEST_P(AnyPair, ImagesAreThoseOfARectifiedCamera) {
  // A smooth picture, as the rendered cameras see it and as the rectified camera should.
  const auto brightness = [](const Eigen::Vector3d& ray) {
    const Eigen::Vector2d p = ray.head<2>() / ray.z();
    return 128.0 + 60.0 * std::sin(9.0 * p.x()) + 50.0 * std::cos(8.0 * p.y() + p.x());
  };
  const Camera rendered = rendered_camera();
  cv::Mat image(rendered.height, rendered.width, CV_8UC1);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      image.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(brightness(rendered.back_project(column, row, 1.0)));
  const cv::Mat rectified = rectification_.rectify_left(pair_.left(image));
  const Eigen::Matrix3d R_rendered_rectified =
      pair_.T_rendered_left().linear() * rectification_.T_left_rectified().linear();
  double worst = 0.0;
  for (int row = 0; row < rectified.rows; row += 5)
    for (int column = 0; column < rectified.cols; column += 5) {
      const double expected = brightness(R_rendered_rectified * rectification_.camera().back_project(column, row, 1.0));
      worst = std::max(worst, std::abs(expected - rectified.at<std::uint8_t>(row, column)));
    }
  EXPECT_LT(worst, 6.0);
}

INSTANTIATE_TEST_SUITE_P(Lenses, AnyPair, testing::Values(test::barrel_camera(), test::fisheye_camera()));

TEST(StereoRectification, AgreesWithOpenCv) {
  const test::RawPair pair(rendered_camera(), test::barrel_camera());
  const StereoCameras& raw = pair.calibration();
  const StereoRectification rectification(raw);
  const auto matrix_of = [](const Camera& camera) -> cv::Mat {
    return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  };
  // OpenCV maps points of the left camera to the right one.
  const Eigen::Isometry3d T_right_left = raw.T_left_right.inverse();
  cv::Mat R(3, 3, CV_64F), t(3, 1, CV_64F), R1, R2, P1, P2, Q;
  for (int row = 0; row < 3; ++row) {
    t.at<double>(row) = T_right_left.translation()[row];
    for (int column = 0; column < 3; ++column) R.at<double>(row, column) = T_right_left.linear()(row, column);
  }
  cv::stereoRectify(matrix_of(raw.left), raw.left.distortion.coefficients(), matrix_of(raw.right),
                    raw.right.distortion.coefficients(), {raw.left.width, raw.left.height}, R, t, R1, R2, P1, P2, Q,
                    cv::CALIB_ZERO_DISPARITY, 0.0);
  // Both put the baseline along the rows; what they choose is the turn about it.
  const Eigen::Matrix3d ours = rectification.T_left_rectified().linear().transpose();
  for (int column = 0; column < 3; ++column) EXPECT_NEAR(R1.at<double>(0, column), ours(0, column), 1e-9);
  for (int row = 1; row < 3; ++row)
    for (int column = 0; column < 3; ++column) EXPECT_NEAR(R1.at<double>(row, column), ours(row, column), 0.01);
  EXPECT_NEAR(P2.at<double>(0, 3) / P2.at<double>(0, 0), -rectification.camera().baseline, 1e-9);
  EXPECT_NEAR(P1.at<double>(0, 0), rectification.camera().fx, 0.08 * rectification.camera().fx);

  // The maps agree where OpenCV is told our rotation and camera.
  cv::Mat ours_cv(3, 3, CV_64F), x, y;
  for (int i = 0; i < 9; ++i) ours_cv.at<double>(i / 3, i % 3) = ours(i / 3, i % 3);
  cv::initUndistortRectifyMap(matrix_of(raw.left), raw.left.distortion.coefficients(), ours_cv,
                              matrix_of(rectification.camera()), {raw.left.width, raw.left.height}, CV_32FC1, x, y);
  cv::Mat noise(raw.left.height, raw.left.width, CV_8UC1), expected, difference;
  cv::theRNG().state = 5;
  cv::randu(noise, 0, 255);
  cv::GaussianBlur(noise, noise, {}, 2.0);
  cv::remap(noise, expected, x, y, cv::INTER_LINEAR);
  cv::absdiff(expected, rectification.rectify_left(noise), difference);
  double largest = 0.0;
  cv::minMaxLoc(difference, nullptr, &largest);
  EXPECT_LE(largest, 2.0);
}

TEST(StereoRectification, APairThatIsRectifiedStaysAsItIs) {
  StereoCameras pair;
  pair.T_left_right.translation().x() = 0.2;
  const StereoRectification rectification(pair);
  EXPECT_TRUE(rectification.T_left_rectified().matrix().isIdentity(1e-12));
  EXPECT_NEAR(rectification.camera().fx, pair.left.fx, 1e-6);
  EXPECT_NEAR(rectification.camera().cx, pair.left.cx, 1e-6);
  EXPECT_NEAR(rectification.camera().baseline, 0.2, 1e-12);
}

TEST(StereoRectification, SaysWhatIsNoPair) {
  const auto message = [](const Eigen::Isometry3d& T_left_right) {
    StereoCameras pair;
    pair.T_left_right = T_left_right;
    try {
      const StereoRectification rectification(pair);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Eigen::Isometry3d exchanged = Eigen::Isometry3d::Identity();
  exchanged.translation().x() = -0.1;
  EXPECT_THAT(message(exchanged), HasSubstr("expected it to the right; exchange the cameras"));
  EXPECT_THAT(message(Eigen::Isometry3d::Identity()), HasSubstr("expected it to the right"));
  Eigen::Isometry3d apart = Eigen::Isometry3d::Identity();
  apart.linear() = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitY()).toRotationMatrix();
  apart.translation().x() = 0.1;
  EXPECT_THAT(message(apart), HasSubstr("no part of their images in common"));
}

}  // namespace
}  // namespace holdfast
