// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {
namespace {

using inertial_consistency_plugin::InertialConsistency;

constexpr std::size_t count = 200;

/// Points before a camera, each seen with a pixel of noise, and a prediction of its pose that errs.
struct PredictedView {
  explicit PredictedView(std::uint64_t seed = 1, bool with_depth = true) : random(seed), has_depth(with_depth) {
    frame.camera = std::make_shared<Camera>(*find_camera("tum_fr3"));
    frame.pyramid = std::make_shared<ScalePyramid>();
    frame.features.resize(count);
    frame.x.resize(count);
    frame.y.resize(count);
    frame.depth.assign(count, 0.0F);
    frame.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < count; ++i) {
      in_camera.push_back({random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6), random.uniform(1.0, 3.0)});
      frame.map_points.push_back(map.add_point(T_camera_world.inverse() * in_camera.back(), 0));
      show(i, Eigen::Vector3d::Zero());
    }
    predict(0.003, 0.002);
  }

  /// Lets a feature show its point displaced in the camera frame [m].
  void show(std::size_t i, const Eigen::Vector3d& displacement) {
    const Eigen::Vector3d point = in_camera[i] + displacement;
    const Eigen::Vector2d pixel = frame.camera->project(point);
    frame.x[i] = static_cast<float>(pixel.x() + random.normal());
    frame.y[i] = static_cast<float>(pixel.y() + random.normal());
    if (!has_depth) return;
    frame.depth[i] = static_cast<float>(point.z());
    frame.right_x[i] = static_cast<float>(frame.camera->right_x(pixel.x(), point.z()) + random.normal());
  }

  /// Draws the error of the prediction by its standard deviations, of which the rotation's is that of one axis alone.
  void predict(double position, double rotation) {
    Eigen::Matrix<double, 6, 1> deviation, error;
    deviation << position, position, position, 0.1 * rotation, rotation, 0.1 * rotation;
    for (int i = 0; i < 6; ++i) error[i] = deviation[i] * random.normal();
    predicted.T_camera_world = (T_camera_world.inverse() * geometry::exp_se3(error)).inverse();
    predicted.covariance = deviation.cwiseAbs2().asDiagonal();
  }

  StaticEvidence evaluate(const InertialConsistencySettings& settings = {}, bool shows_prediction = true) const {
    InertialConsistency filter(settings, {});
    const SensorFrame image;
    StaticEvidence evidence(count);
    evidence.begin_stage("filter");
    filter.apply({.sensor_frame = image,
                  .frame = frame,
                  .map = map,
                  .T_camera_world = &wrong_pose,
                  .inertial_prediction = shows_prediction ? &predicted : nullptr},
                 evidence);
    return evidence;
  }

  Random random;
  bool has_depth;
  Eigen::Isometry3d T_camera_world =
      Eigen::Translation3d(0.3, -0.2, 0.1) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  /// Of the images: it follows somebody, and the filter must not look at it.
  Eigen::Isometry3d wrong_pose = Eigen::Translation3d(0.1, 0.0, 0.0) * T_camera_world;
  std::vector<Eigen::Vector3d> in_camera;
  Map map;
  Frame frame;
  PredictedPose predicted;
};

std::size_t moving(const StaticEvidence& evidence, std::size_t begin = 0) {
  std::size_t found = 0;
  for (std::size_t i = begin; i < evidence.size(); ++i) found += evidence.measurement(i) < 0.0F ? 1 : 0;
  return found;
}

TEST(InertialConsistency, WhatMovesContradictsThePredictionWhateverThePoseOfTheImages) {
  for (const bool with_depth : {true, false}) {
    PredictedView view(1, with_depth);
    // Most of the view walks by 12 cm.
    for (std::size_t i = 0; i < 140; ++i) view.show(i, {0.12, 0.0, 0.0});
    const StaticEvidence evidence = view.evaluate();
    EXPECT_GT(moving(evidence) - moving(evidence, 140), 130U) << with_depth;
    EXPECT_LT(moving(evidence, 140), 3U) << with_depth;
  }
}

TEST(InertialConsistency, StaticMatchesPassByTheCovarianceOfThePrediction) {
  std::size_t failed = 0, failed_as_if_exact = 0;
  InertialConsistencySettings settings;
  settings.pixel_deviation = 1.0;
  settings.inflation = 1.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    PredictedView view(seed);
    failed += moving(view.evaluate(settings));
    view.predicted.covariance.setZero();
    failed_as_if_exact += moving(view.evaluate(settings));
  }
  const double share = static_cast<double>(failed) / (60.0 * count);
  EXPECT_NEAR(share, 0.01, 0.007) << "of the 99 % quantile";
  EXPECT_GT(failed_as_if_exact, 5 * failed);
}

TEST(InertialConsistency, AcrossTheUncertainAxisMoreMotionIsAllowed) {
  PredictedView view;
  view.predict(0.0005, 0.008);  // about the vertical axis of the camera: columns are uncertain by 4 px
  for (std::size_t i = 0; i < 20; ++i) view.show(i, {0.006 * view.in_camera[i].z(), 0.0, 0.0});
  for (std::size_t i = 20; i < 40; ++i) view.show(i, {0.0, 0.02 * view.in_camera[i].z(), 0.0});
  InertialConsistencySettings settings;
  settings.inflation = 1.0;
  const StaticEvidence evidence = view.evaluate(settings);
  std::size_t sideways = 0, vertical = 0;
  for (std::size_t i = 0; i < 20; ++i) sideways += evidence.measurement(i) < 0.0F ? 1 : 0;
  for (std::size_t i = 20; i < 40; ++i) vertical += evidence.measurement(i) < 0.0F ? 1 : 0;
  EXPECT_LT(sideways, 4U);
  EXPECT_GT(vertical, 16U);
}

TEST(InertialConsistency, IsSilentWhereItCannotTell) {
  PredictedView view;
  for (std::size_t i = 0; i < 60; ++i) view.show(i, {0.12, 0.0, 0.0});
  EXPECT_GT(moving(view.evaluate()), 50U);
  EXPECT_TRUE(view.evaluate({}, false).contributions().empty()) << "no prediction";
  view.predicted.covariance *= 100.0;
  EXPECT_TRUE(view.evaluate().contributions().empty()) << "an uncertain one";
  view.predicted.covariance /= 100.0;
  view.predicted.T_camera_world = Eigen::Translation3d(0.2, 0.0, 0.0) * view.predicted.T_camera_world;
  EXPECT_TRUE(view.evaluate().contributions().empty()) << "a wrong one, with which hardly a match agrees";
}

TEST(InertialConsistency, EvidenceGrowsWithTheInnovation) {
  PredictedView view;
  InertialConsistencySettings settings;
  settings.static_log_odds = 0.2;
  view.show(3, {0.0, 0.0, 0.0});
  view.show(4, {0.03 * view.in_camera[4].z(), 0.0, 0.0});
  view.show(5, {0.3, 0.0, 0.0});
  const StaticEvidence evidence = view.evaluate(settings);
  EXPECT_FLOAT_EQ(evidence.measurement(3), 0.2F);
  EXPECT_LE(evidence.measurement(4), -0.37F);
  EXPECT_GT(evidence.measurement(4), -1.5F);
  EXPECT_FLOAT_EQ(evidence.measurement(5), -1.5F);
}

}  // namespace
}  // namespace holdfast
