// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_frames.hpp"

#include <gtest/gtest.h>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::bridge {
namespace {

Eigen::Isometry3d pose(double x, double y, double yaw) {
  Eigen::Isometry3d T(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  return T;
}

double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return (a.matrix() - b.matrix()).norm(); }

TEST(OdometryFrames, BeginWithTheMapAndChainToIt) {
  OdometryFrames frames;
  frames.add(pose(1, 2, 0.3), std::nullopt);
  EXPECT_LT(distance(frames.T_map_odom(), Eigen::Isometry3d::Identity()), 1e-12);
  EXPECT_LT(distance(frames.T_odom_base(), pose(1, 2, 0.3)), 1e-12);
}

TEST(OdometryFrames, ACorrectionOfTheMapMovesOdomAndNotTheRobotInIt) {
  OdometryFrames frames;
  frames.add(pose(0, 0, 0), std::nullopt);
  const Eigen::Isometry3d motion = pose(0.1, 0, 0.05);
  Eigen::Isometry3d in_map = pose(0, 0, 0), expected = in_map;
  for (int i = 0; i < 50; ++i) {
    if (i == 25) in_map = pose(0.5, -0.3, 0.1) * in_map;  // a loop was closed
    in_map = in_map * motion, expected = expected * motion;
    frames.add(in_map, motion);
    EXPECT_LT(distance(frames.T_odom_base(), expected), 1e-9) << i;
    EXPECT_LT(distance(frames.T_map_odom() * frames.T_odom_base(), in_map), 1e-9) << i;
  }
  EXPECT_NEAR(frames.T_map_odom().translation().x(), 0.5, 1e-9);
  EXPECT_NEAR(frames.T_map_odom().translation().y(), -0.3, 1e-9);
}

TEST(OdometryFrames, TheOdometryStandsStillWhereNothingIsKnown) {
  OdometryFrames frames;
  frames.add(pose(0, 0, 0), std::nullopt);
  frames.add(pose(1, 0, 0), pose(1, 0, 0));
  frames.add(pose(4, 4, 1), std::nullopt);  // found after a loss
  EXPECT_LT(distance(frames.T_odom_base(), pose(1, 0, 0)), 1e-12);
  EXPECT_LT(distance(frames.T_map_odom() * frames.T_odom_base(), pose(4, 4, 1)), 1e-12);
}

TEST(OdometryFrames, TakesTheOdometryOfTheWheels) {
  OdometryFrames frames;
  frames.add_with_odometry(pose(3, 1, 0.2), pose(2, 0, 0.1));
  EXPECT_LT(distance(frames.T_odom_base(), pose(2, 0, 0.1)), 1e-12);
  EXPECT_LT(distance(frames.T_map_odom() * pose(2, 0, 0.1), pose(3, 1, 0.2)), 1e-12);
}

/// Against numeric derivatives of the pose of the robot by errors of that of the camera.
TEST(OdometryFrames, TheCovarianceIsThatOfTheRobotInTheMap) {
  Eigen::Isometry3d T_base_camera = pose(0.4, -0.1, 0.2);
  T_base_camera.linear() = T_base_camera.linear() * Eigen::AngleAxisd(-1.4, Eigen::Vector3d::UnitX());
  T_base_camera.translation().z() = 0.7;
  const Eigen::Isometry3d T_map_base = pose(2, 3, 0.8);
  Eigen::Matrix<double, 6, 6> J;
  const double step = 1e-6;
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
    d(i) = step;
    const Eigen::Isometry3d moved = T_map_base * T_base_camera * geometry::exp_se3(d) * T_base_camera.inverse();
    const Eigen::AngleAxisd turned(moved.linear() * T_map_base.linear().transpose());
    J.col(i) << (moved.translation() - T_map_base.translation()) / step, turned.angle() / step * turned.axis();
  }
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = 0.01 * ((7 * i) % 11 - 5);
  const Eigen::Matrix<double, 6, 6> covariance = A * A.transpose();
  EXPECT_LT((covariance_in_map(covariance, T_map_base, T_base_camera) - J * covariance * J.transpose()).norm(),
            1e-4 * covariance.norm());
}

TEST(OdometryFrames, VelocityOfAMotion) {
  const Eigen::Matrix<double, 6, 1> velocity = velocity_of(pose(0.1, 0.2, 0.3), 0.1);
  EXPECT_NEAR(velocity(0), 1.0, 1e-12);
  EXPECT_NEAR(velocity(1), 2.0, 1e-12);
  EXPECT_NEAR(velocity(5), 3.0, 1e-9);
  EXPECT_EQ(velocity_of(pose(1, 0, 0), 0.0).norm(), 0.0);
}

}  // namespace
}  // namespace holdfast::bridge
