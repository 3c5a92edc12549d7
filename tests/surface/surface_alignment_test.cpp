// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/geometry/se3.hpp"
#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

using test::SolidWorld;

class SurfaceAlignmentTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
    world.camera.width = 480, world.camera.height = 360;
    world.camera.fx = world.camera.fy = 390;
    world.camera.cx = 239.5, world.camera.cy = 179.5;
    world.has_wall = true;
  }
  SurfaceField field() const {
    SurfaceField field(world.camera, SurfaceSettings{});
    for (std::uint32_t i = 0; i < 4; ++i)
      field.put_in(world.view(pose(0.05 * i - 0.1, 0.0), i), pose(0.05 * i - 0.1, 0.0), i);
    return field;
  }
  /// T_world_camera: to the right by `x` [m], turned by `angle` [rad].
  static Eigen::Isometry3d pose(double x, double angle) {
    return geometry::exp_se3((geometry::Vector6d() << x, 0.5 * x, 0, 0.5 * angle, angle, 0).finished());
  }
  CoarseView coarse_at(const Eigen::Isometry3d& T_world_camera) const {
    const KeptView view = world.view(T_world_camera, 9);
    cv::Mat depth;
    view.depth.convertTo(depth, CV_32F, KeptView::depth_unit);
    CoarseView coarse;
    CoarseSampler(world.camera).sample_depth(depth, coarse);
    return coarse;
  }
  static double error(const Eigen::Isometry3d& T_view_world, const Eigen::Isometry3d& T_world_view) {
    return (T_view_world * T_world_view).translation().norm();
  }

  SolidWorld world;
};

TEST_F(SurfaceAlignmentTest, FindsThePoseFromAPredictionNearby) {
  const SurfaceField surface = field();
  const Eigen::Isometry3d truth = pose(0.06, 0.02), predicted = pose(0.04, 0.012);
  const auto aligned = align_with_surface(surface, coarse_at(truth), world.camera, predicted.inverse());
  ASSERT_TRUE(aligned);
  EXPECT_GT(error(predicted.inverse(), truth), 0.02);
  EXPECT_LT(error(*aligned, truth), 0.004);
}

TEST_F(SurfaceAlignmentTest, PosesThatArePredictedFromEachOtherStayRigid) {
  const SurfaceField surface = field();
  Eigen::Isometry3d last = pose(0.0, 0.0).inverse(), before_last = last;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Isometry3d truth = pose(0.1 * std::sin(0.1 * i), 0.0);
    const auto aligned =
        align_with_surface(surface, coarse_at(truth), world.camera, last * before_last.inverse() * last);
    ASSERT_TRUE(aligned) << i;
    ASSERT_LT(error(*aligned, truth), 0.01) << i;
    before_last = std::exchange(last, *aligned);
  }
}

TEST_F(SurfaceAlignmentTest, SomebodyBeforeTheSurfaceDoesNotCount) {
  const SurfaceField surface = field();
  const Eigen::Isometry3d truth = pose(0.06, 0.02), predicted = pose(0.04, 0.012);
  CoarseView view = coarse_at(truth);
  // On the left 0.8 m before the camera; on the right of the ball, at its distance, and known to move.
  view.static_log_odds.assign(view.depth.size(), 0.0F);
  for (int cell = 0; cell < view.grid.size(); ++cell) {
    const int column = cell % view.grid.columns;
    if (column < view.grid.columns / 3) view.depth[static_cast<std::size_t>(cell)] = 0.8F;
    if (column < view.grid.columns * 9 / 10) continue;
    view.depth[static_cast<std::size_t>(cell)] = 2.46F;
    view.static_log_odds[static_cast<std::size_t>(cell)] = -1.0F;
  }
  const auto aligned = align_with_surface(surface, view, world.camera, predicted.inverse());
  ASSERT_TRUE(aligned);
  EXPECT_LT(error(*aligned, truth), 0.006);
}

TEST_F(SurfaceAlignmentTest, APlaneLeavesItsDirectionsAsPredicted) {
  world.has_ball = false;
  const Eigen::Isometry3d truth = pose(0.0, 0.0);
  Eigen::Isometry3d predicted = truth;
  predicted.translation() = Eigen::Vector3d(0.02, 0.0, 0.02);
  const auto aligned = align_with_surface(field(), coarse_at(truth), world.camera, predicted.inverse());
  ASSERT_TRUE(aligned);
  EXPECT_NEAR(aligned->inverse().translation().z(), 0.0, 0.003);
  EXPECT_NEAR(aligned->inverse().translation().x(), 0.02, 0.003);
}

TEST_F(SurfaceAlignmentTest, WhatIsNotTheSurfaceGivesNoPose) {
  const SurfaceField surface = field();
  const CoarseView view = coarse_at(pose(0.0, 0.0));
  Eigen::Isometry3d elsewhere = Eigen::Isometry3d::Identity();
  elsewhere.translation().z() = -0.5;
  EXPECT_FALSE(align_with_surface(surface, view, world.camera, elsewhere.inverse()));
  EXPECT_FALSE(align_with_surface(surface, {}, world.camera, pose(0.0, 0.0).inverse()));
  EXPECT_FALSE(
      align_with_surface(SurfaceField(world.camera, SurfaceSettings{}), view, world.camera, pose(0.0, 0.0).inverse()));
}

}  // namespace
}  // namespace holdfast
