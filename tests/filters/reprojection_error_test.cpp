// SPDX-License-Identifier: BSD-3-Clause
#include "reprojection_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using reprojection_error_plugin::ReprojectionError;

/// Points before a camera that stands at a turned place, and frames that show them displaced.
class ObservedPoints {
 public:
  explicit ObservedPoints(bool with_depth = true) : camera_(std::make_shared<Camera>(*find_camera("tum_fr3"))) {
    T_camera_world_ =
        Eigen::Translation3d(0.3, -0.2, 0.1) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    Random random(3);
    frame_.camera = camera_;
    frame_.pyramid = std::make_shared<ScalePyramid>();
    const std::size_t count = 100;
    frame_.features.resize(count);
    frame_.static_probability.assign(count, 1.0F);
    for (std::size_t i = 0; i < count; ++i) {
      in_camera_.push_back({random.uniform(-0.8, 0.8), random.uniform(-0.6, 0.6), random.uniform(1.0, 3.0)});
      frame_.map_points.push_back(map_.add_point(T_camera_world_.inverse() * in_camera_.back(), 0));
      frame_.features.octave[i] = static_cast<std::uint8_t>(i % 3);
    }
    frame_.x.resize(count);
    frame_.y.resize(count);
    frame_.depth.assign(count, 0.0F);
    frame_.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < count; ++i) show(i, Eigen::Vector3d::Zero(), with_depth);
  }

  /// Lets a feature show its point displaced in the camera frame [m].
  void show(std::size_t i, const Eigen::Vector3d& displacement, bool with_depth = true) {
    const Eigen::Vector3d point = in_camera_[i] + displacement;
    const Eigen::Vector2d pixel = camera_->project(point);
    frame_.x[i] = static_cast<float>(pixel.x());
    frame_.y[i] = static_cast<float>(pixel.y());
    if (!with_depth) return;
    frame_.depth[i] = static_cast<float>(point.z());
    frame_.right_x[i] = static_cast<float>(camera_->right_x(pixel.x(), point.z()));
  }

  StaticEvidence evaluate(ReprojectionError& filter) const {
    const SensorFrame image;
    StaticEvidence evidence(frame_.size());
    evidence.begin_stage("filter");
    filter.apply({.sensor_frame = image, .frame = frame_, .map = map_, .T_camera_world = &T_camera_world_}, evidence);
    return evidence;
  }

  Frame& frame() { return frame_; }
  Map& map() { return map_; }

 private:
  std::shared_ptr<Camera> camera_;
  Eigen::Isometry3d T_camera_world_;
  std::vector<Eigen::Vector3d> in_camera_;
  Map map_;
  Frame frame_;
};

ReprojectionErrorSettings settings() {
  ReprojectionErrorSettings settings;
  settings.support = 0.5;
  settings.moving_log_odds = -4.0;
  settings.static_log_odds = 0.3;
  return settings;
}

const Eigen::Vector3d step(0.06, 0.01, 0.02);

TEST(ReprojectionError, DoubtGrowsWithEveryFrameThatFails) {
  ObservedPoints points;
  ReprojectionError filter(settings(), {});
  float before = 0.0F;
  for (int k = 1; k <= 3; ++k) {
    points.show(7, k * step);
    const StaticEvidence evidence = points.evaluate(filter);
    EXPECT_LT(evidence.measurement(7), before);
    EXPECT_GT(evidence.measurement(8), 0.0F);
    before = evidence.measurement(7);
  }
  EXPECT_FLOAT_EQ(before, -4.0F);
  // It is where it was again: no longer moving, and not as trustworthy as one that never failed.
  points.show(7, Eigen::Vector3d::Zero());
  const StaticEvidence evidence = points.evaluate(filter);
  EXPECT_GE(evidence.measurement(7), 0.0F);
  EXPECT_LT(evidence.measurement(7), evidence.measurement(8));
}

TEST(ReprojectionError, WithoutSofteningAMatchIsDynamicAfterTheGivenFailures) {
  ReprojectionErrorSettings printed = settings();
  printed.soften = false;
  printed.frames = 3;
  ObservedPoints points;
  ReprojectionError filter(printed, {});
  // To and fro: softening would halve the evidence.
  for (int k = 1; k <= 4; ++k) {
    points.show(7, Eigen::Vector3d(k % 2 == 0 ? 0.03 : -0.03, 0, 0));
    EXPECT_EQ(points.evaluate(filter).measurement(7), k < 3 ? 0.0F : -4.0F) << k;
  }
  points.map().point(points.frame().map_points[9]).visible_count = 100;  // hardly ever found where it is predicted
  points.show(9, step);
  EXPECT_EQ(points.evaluate(filter).measurement(9), -4.0F);
}

TEST(ReprojectionError, NoiseWithinTheVarianceOfTheLevelPasses) {
  ObservedPoints points;
  ReprojectionError filter(settings(), {});
  for (std::size_t i = 0; i < points.frame().size(); ++i)
    points.frame().x[i] += 1.4F * points.frame().pyramid->scale[points.frame().features.octave[i]];
  points.frame().x[2] += 6.0F;
  const StaticEvidence evidence = points.evaluate(filter);
  for (std::size_t i = 0; i < evidence.size(); ++i) EXPECT_EQ(evidence.measurement(i) < 0.0F, i == 2) << i;
}

TEST(ReprojectionError, DepthAloneTellsWhatComesNearer) {
  for (const bool with_depth : {true, false}) {
    ObservedPoints points(with_depth);
    ReprojectionError filter(settings(), {});
    const float x = points.frame().x[5], y = points.frame().y[5];
    points.show(5, Eigen::Vector3d(0, 0, -0.4), with_depth);
    points.frame().x[5] = x, points.frame().y[5] = y;
    EXPECT_EQ(points.evaluate(filter).measurement(5) < 0.0F, with_depth);
  }
}

TEST(ReprojectionError, DisplacementsThatDisagreeCountLess) {
  ObservedPoints points;
  ReprojectionError filter(settings(), {});
  StaticEvidence evidence;
  for (int k = 0; k < 6; ++k) {
    points.show(3, 4 * step);
    points.show(4, (k % 2 == 0 ? 4 : -4) * step);
    evidence = points.evaluate(filter);
  }
  EXPECT_FLOAT_EQ(evidence.measurement(3), -4.0F);
  EXPECT_FLOAT_EQ(evidence.measurement(4), -2.0F);
}

TEST(ReprojectionError, IsSilentWhenThePoseIsWrong) {
  ObservedPoints points;
  ReprojectionError filter(settings(), {});
  for (std::size_t i = 0; i < 60; ++i) points.show(i, step);
  EXPECT_TRUE(points.evaluate(filter).contributions().empty());
  // Unless other evidence speaks against those that fail.
  for (std::size_t i = 0; i < 60; ++i) points.frame().static_probability[i] = 0.1F;
  const StaticEvidence evidence = points.evaluate(filter);
  EXPECT_LT(evidence.measurement(0), 0.0F);
  EXPECT_GT(evidence.measurement(99), 0.0F);
}

TEST(ReprojectionError, ANewPointInAnOldSlotBeginsAnew) {
  ObservedPoints points;
  ReprojectionError filter(settings(), {});
  StaticEvidence evidence;
  for (int k = 1; k <= 4; ++k) {
    points.show(7, k * step);
    evidence = points.evaluate(filter);
  }
  const MapPointId gone = points.frame().map_points[7];
  const Eigen::Vector3d position = points.map().point(gone).position;
  points.map().remove_point(gone);
  points.frame().map_points[7] = points.map().add_point(position, 0);
  ASSERT_EQ(points.frame().map_points[7].slot, gone.slot);
  EXPECT_GT(points.evaluate(filter).measurement(7), evidence.measurement(7) / 2.0F);
}

}  // namespace
}  // namespace holdfast
