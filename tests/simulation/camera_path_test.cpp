// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/camera_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {
namespace {

Stage office() { return make_stage(RoomKind::office); }

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

TEST(CameraPath, NamesAndKindsBelongTogether) {
  for (const std::string& name : path_names()) EXPECT_EQ(to_string(path_kind(name)), name);
  EXPECT_THROW(path_kind("circle"), ConfigurationError);
}

TEST(CameraPath, StartsAtRestAndMovesSmoothlyAtTheSpeedOfAHand) {
  for (const std::string& name : path_names())
    for (const std::uint64_t seed : {1, 2, 7}) {
      const CameraPath path(path_kind(name), office(), seed);
      EXPECT_LT((path.pose(0.001).translation() - path.pose(0).translation()).norm(), 1e-6) << name;
      constexpr double step = 1.0 / 30.0;
      double fastest = 0, fastest_turn = 0, way = 0, largest_change = 0;
      Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
      for (int i = 0; i < 900; ++i) {
        const Eigen::Isometry3d now = path.pose(i * step), next = path.pose((i + 1) * step);
        const Eigen::Vector3d moved = next.translation() - now.translation();
        way += moved.norm();
        fastest = std::max(fastest, moved.norm() / step);
        fastest_turn = std::max(fastest_turn, angle_between(now, next) / step);
        largest_change = std::max(largest_change, (moved / step - velocity).norm());
        velocity = moved / step;
        ASSERT_NEAR((now.linear().transpose() * now.linear() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-9);
      }
      EXPECT_LT(fastest, 0.9) << name;
      EXPECT_LT(fastest_turn, 1.3) << name;
      EXPECT_LT(largest_change, 0.12) << name;  // no jumps: 3.6 m/s^2
      const double mean = way / 30.0;
      if (name == "xyz") {
        EXPECT_GT(mean, 0.2);
        EXPECT_LT(mean, 0.5);
        EXPECT_LT(fastest_turn, 0.2);  // it looks the same way all the time
      }
      if (name == "static") {
        EXPECT_LT(mean, 0.06);
      }
      if (name == "rpy") {
        EXPECT_GT(fastest_turn, 0.3);
        EXPECT_LT(mean, 0.2);
      }
    }
}

TEST(CameraPath, KeepsToItsPlace) {
  for (const std::uint64_t seed : {1, 2, 7}) {
    Eigen::Vector3d low, high;
    for (const auto& [kind, least, most] : {std::tuple(PathKind::fixed, 0.0, 0.04),
                                            {PathKind::xyz, 0.4, 0.95},
                                            {PathKind::rpy, 0.0, 0.12},
                                            {PathKind::halfsphere, 0.5, 3.0}}) {
      const CameraPath path(kind, office(), seed);
      low.setConstant(1e9), high.setConstant(-1e9);
      for (double time = 0; time < 40; time += 0.1) {
        const Eigen::Vector3d position = path.pose(time).translation();
        low = low.cwiseMin(position), high = high.cwiseMax(position);
      }
      EXPECT_LE((high - low).maxCoeff(), most) << to_string(kind);
      EXPECT_GE((high - low).minCoeff(), least) << to_string(kind);
      EXPECT_GT(low.minCoeff(), 0.5) << to_string(kind);  // inside the room
      EXPECT_LT(high.z(), 2.5) << to_string(kind);
    }
  }
}

TEST(CameraPath, SeedChangesTheMotion) {
  EXPECT_GT((CameraPath(PathKind::xyz, office(), 1).pose(3).translation() -
             CameraPath(PathKind::xyz, office(), 2).pose(3).translation())
                .norm(),
            0.01);
}

TEST(CameraPath, LookAtPutsTheTargetOnTheOpticalAxisAndTheHorizonLevel) {
  const Eigen::Isometry3d T_world_camera = look_at({1, 2, 1.5}, {3, 4, 0.5});
  const Eigen::Vector3d target = T_world_camera.inverse() * Eigen::Vector3d(3, 4, 0.5);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_NEAR(target.z(), 3, 1e-12);
  EXPECT_NEAR(T_world_camera.linear().col(0).z(), 0, 1e-12);  // x is level
  EXPECT_LT(T_world_camera.linear().col(1).z(), 0);           // y points down
  EXPECT_NEAR(T_world_camera.linear().determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace holdfast::simulation
