// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "holdfast/core/random.hpp"
#include "holdfast/mapping/pair_calibrator.hpp"
#include "pair_bundle.hpp"

namespace holdfast {
namespace {

Camera street_camera() {
  Camera camera;
  camera.width = 1226, camera.height = 370;
  camera.fx = camera.fy = 707.0;
  camera.cx = 602.0, camera.cy = 183.0;
  camera.baseline = 0.54;
  return camera;
}

/// Ten keyframes of a pair that drives along a street, whose right columns are displaced, and the map that follows from
/// the displaced disparities.
class PairBundleTest : public ::testing::Test {
 protected:
  void drive(double metres_per_keyframe, double moving_share = 0.0) {
    constexpr std::size_t keyframes = 10, points = 400;
    constexpr double map_scale = 1.02;  // that of wrong disparities
    problem_.camera = &camera_;
    for (std::size_t k = 0; k < keyframes; ++k) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation().z() = -map_scale * metres_per_keyframe * static_cast<double>(k);
      problem_.poses.push_back({pose, k == 0});
    }
    while (problem_.points.size() < points) add_point(metres_per_keyframe, map_scale, moving_share);
  }

  void add_point(double metres_per_keyframe, double map_scale, double moving_share) {
    const double depth = 1.0 / random_.uniform(1.0 / 60.0, 1.0 / 8.0);
    Eigen::Vector3d point =
        camera_.back_project(random_.uniform(0.0, 1226.0), random_.uniform(0.0, camera_.height), depth);
    const auto index = static_cast<std::uint32_t>(problem_.points.size());
    const double speed = random_.uniform(0.0, 1.0) < moving_share ? 0.2 : 0.0;  // m a keyframe, across
    const std::size_t begin = problem_.observations.size();
    problem_.points.push_back(map_scale * point);
    for (std::size_t k = 0; k < problem_.poses.size(); ++k) {
      const Eigen::Vector3d seen = point + Eigen::Vector3d(speed, 0.0, -metres_per_keyframe) * static_cast<double>(k);
      if (seen.z() < 4.0) break;
      const Eigen::Vector2d pixel = camera_.project(seen);
      if (pixel.x() < 0.0 || pixel.x() > camera_.width || pixel.y() < 0.0 || pixel.y() > camera_.height) break;
      const double x = pixel.x() + 0.3 * random_.normal(), y = pixel.y() + 0.3 * random_.normal();
      const double right = camera_.right_x(pixel.x(), seen.z());
      const Eigen::Vector2d at = camera_.normalised(right, pixel.y());
      const Eigen::Vector4d terms(1.0, at.squaredNorm(), at.x(), at.x() * at.squaredNorm());
      const bool is_coarse = index % 10 < coarse_tenths_;
      const double displaced = terms.dot(truth_) + lens_.column(camera_, right, pixel.y()) + (is_coarse ? 1.0 : 0.0);
      problem_.observations.push_back(
          {.pose = static_cast<std::uint32_t>(k),
           .point = index,
           .x = static_cast<float>(x),
           .y = static_cast<float>(y),
           .right_x = static_cast<float>(right + x - pixel.x() + displaced + 0.3 * random_.normal()),
           .inverse_sigma2 = is_coarse ? 1.0F / 16.0F : 1.0F});
    }
    if (problem_.observations.size() - begin >= 3) return;
    problem_.observations.resize(begin);
    problem_.points.pop_back();
  }

  Random random_{5};
  Camera camera_ = street_camera();
  Eigen::Vector4d truth_ = Eigen::Vector4d::Zero();  // as ColumnEstimate::value
  PairErrors lens_;                                  // displaces columns as well
  std::uint32_t coarse_tenths_ = 0;                  // of the points, whose columns are 1 px off
  BundleProblem problem_;
};

TEST_F(PairBundleTest, MotionDeterminesTheDisplacementOfColumns) {
  truth_ << 0.5, -0.4, 0.6, -1.0;
  drive(1.2);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  const Eigen::Vector4d sigma = found->information.inverse().eval().diagonal().cwiseSqrt();
  for (int term = 0; term < 4; ++term) EXPECT_NEAR(found->value[term], truth_[term], 3.0 * sigma[term]) << term;
  EXPECT_LT(sigma[0], 0.1);
  EXPECT_NEAR(problem_.poses.back().T_camera_world.translation().z(), -9 * 1.2, 0.02 * 9 * 1.2);
}

TEST_F(PairBundleTest, APerfectPairIsFoundPerfect) {
  drive(1.2);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  const Eigen::Vector4d sigma = found->information.inverse().eval().diagonal().cwiseSqrt();
  for (int term = 0; term < 4; ++term) EXPECT_LT(std::abs(found->value[term]), 3.0 * sigma[term]) << term;
}

TEST_F(PairBundleTest, WhatMovesIsSetAside) {
  truth_[0] = 0.5;
  drive(1.2, 0.1);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value[0], 0.5, 0.15);
}

TEST_F(PairBundleTest, DisparitiesOfCoarseFeaturesCountLess) {
  coarse_tenths_ = 3;
  drive(1.2);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value[0], 0.0, 0.15);
}

/// Of decentring, rows tell the product, and motion the rest.
TEST_F(PairBundleTest, ColumnsOfDecentringFollowFromTheProductInTheRows) {
  camera_.height = 1000, camera_.cy = 500.0;
  PairErrors truth, used;
  truth.rotation.y() = 1.0 / camera_.fx;
  truth.decentring = -2.0 / camera_.fx;
  used.decentring = -truth.row_product();  // what rows have told
  lens_.rotation.y() = truth.rotation.y() - used.rotation.y();
  lens_.decentring = truth.decentring - used.decentring;
  drive(1.2);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  const Eigen::Vector4d sigma = found->information.inverse().eval().diagonal().cwiseSqrt();
  EXPECT_NEAR(found->value[0], 1.0, 3.0 * sigma[0]);
  EXPECT_NEAR(found->value[1], 1.0, 3.0 * sigma[1]);
  EXPECT_LT(sigma[1], 0.25);
  for (int term = 2; term < 4; ++term) EXPECT_LT(std::abs(found->value[term]), 3.0 * sigma[term]) << term;
}

/// Radial distortion is uncertain where the view is narrow, and displaces little there.
TEST_F(PairBundleTest, ANarrowViewIsNotImplausible) {
  camera_.fx = camera_.fy = 2000.0;
  truth_[0] = 0.5;
  drive(1.2);
  const std::optional<ColumnEstimate> found = PairBundle().solve(problem_);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->value[0], 0.5, 3.0 * std::sqrt(found->information.inverse().eval()(0, 0)));
}

TEST_F(PairBundleTest, WithoutMotionNothingIsDetermined) {
  truth_[0] = 0.5;
  drive(0.0);
  EXPECT_FALSE(PairBundle().solve(problem_));
}

TEST(PairCalibratorTest, KeyframesAreCorrectedInRetrospect) {
  const Camera camera = street_camera();
  Map map;
  MapMutex mutex;
  StereoCalibration calibration(camera, {}, true);
  PairCalibrator calibrator(map, mutex, calibration);
  Frame frame;
  frame.camera = std::make_shared<const Camera>(camera);
  frame.pyramid = std::make_shared<const ScalePyramid>();
  frame.x = frame.features.x = {600.0F, 600.0F, 600.0F};
  frame.y = frame.features.y = {180.0F, 180.0F, 180.0F};
  frame.features.octave.resize(3), frame.features.angle.resize(3), frame.features.response.resize(3);
  frame.map_points.resize(3), frame.static_probability.resize(3), frame.measured_log_odds.resize(3);
  const auto none = std::numeric_limits<float>::quiet_NaN();
  frame.right_x = {590.0F, none, 599.8F};
  frame.depth = {1.0F, 0.0F, 1.0F};
  calibration.begin_frame();
  const KeyFrameId id = map.add_keyframe(frame);
  calibrator.add(MapAccess(map), id);
  EXPECT_FALSE(calibrator.correct(MapAccess(map)));

  ColumnEstimate estimate;
  estimate.value[0] = -0.5;  // the right image shows everything half a pixel too far left
  estimate.information.diagonal().setConstant(1e4);
  calibration.learn_columns(estimate, {}, true);
  EXPECT_TRUE(calibrator.correct(MapAccess(map)));
  const Frame& corrected = map.keyframe(id).frame;
  EXPECT_NEAR(corrected.right_x[0], 590.5, 0.01);
  EXPECT_NEAR(corrected.depth[0], 707.0 * 0.54 / 9.5, 0.05);
  EXPECT_TRUE(std::isnan(corrected.right_x[1]));
  EXPECT_TRUE(std::isnan(corrected.right_x[2])) << "a disparity below 0";
  EXPECT_EQ(corrected.depth[2], 0.0F);
  EXPECT_FALSE(calibrator.correct(MapAccess(map)));
}

}  // namespace
}  // namespace holdfast
