// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/camera_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Vector3d;

constexpr PathStyle steady{.speed = 1.0, .shake = 0.0};

Stage office() { return make_stage(RoomKind::office); }
Stage hall() { return make_stage(RoomKind::hall); }

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

double heading(const Eigen::Isometry3d& pose) { return std::atan2(pose.linear()(1, 2), pose.linear()(0, 2)); }

TEST(CameraPath, NamesAndKindsBelongTogether) {
  ASSERT_EQ(path_names().size(), 9U);
  for (const std::string& name : path_names()) EXPECT_EQ(to_string(path_kind(name)), name);
  EXPECT_EQ(path_kind("waypoints"), PathKind::waypoints);
  EXPECT_THROW(path_kind("circle"), ConfigurationError);
}

TEST(CameraPath, StartsAtRestAndMovesSmoothlyAtTheSpeedOfSomebodyWhoHoldsIt) {
  for (const std::string& room : room_names())
    for (const std::string& name : path_names())
      for (const std::uint64_t seed : {1, 7}) {
        const CameraPath path(path_kind(name), make_stage(room_kind(room)), seed);
        EXPECT_LT((path.pose(0.001).translation() - path.pose(0).translation()).norm(), 1e-6) << name;
        constexpr double step = 1.0 / 30.0;
        double fastest = 0, fastest_turn = 0, way = 0, largest_change = 0, largest_turn_change = 0;
        Vector3d velocity = Vector3d::Zero();
        double turn = 0;
        const int count = static_cast<int>(std::max(30.0, 1.1 * path.cycle()) / step);
        Eigen::Isometry3d now = path.pose(0);
        for (int i = 0; i < count; ++i) {
          const Eigen::Isometry3d next = path.pose((i + 1) * step);
          const Vector3d moved = next.translation() - now.translation();
          const double turned = angle_between(now, next);
          way += moved.norm();
          fastest = std::max(fastest, moved.norm() / step);
          fastest_turn = std::max(fastest_turn, turned / step);
          largest_change = std::max(largest_change, (moved / step - velocity).norm());
          largest_turn_change = std::max(largest_turn_change, std::abs(turned - turn) / step);
          velocity = moved / step, turn = turned, now = next;
          ASSERT_NEAR((now.linear().transpose() * now.linear() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-9);
        }
        EXPECT_LT(fastest, 1.0) << room << ' ' << name;
        EXPECT_LT(fastest_turn, 1.2) << room << ' ' << name;
        EXPECT_LT(largest_change, 0.14) << room << ' ' << name;  // no jumps: 4.2 m/s^2
        EXPECT_LT(largest_turn_change, 0.15) << room << ' ' << name;
        const double mean = way / (count * step);
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
    Vector3d low, high;
    for (const auto& [kind, least, most] : {std::tuple(PathKind::fixed, 0.0, 0.04),
                                            {PathKind::xyz, 0.4, 0.95},
                                            {PathKind::rpy, 0.0, 0.12},
                                            {PathKind::halfsphere, 0.5, 3.0}}) {
      const CameraPath path(kind, office(), seed);
      low.setConstant(1e9), high.setConstant(-1e9);
      for (double time = 0; time < 40; time += 0.1) {
        const Vector3d position = path.pose(time).translation();
        low = low.cwiseMin(position), high = high.cwiseMax(position);
      }
      EXPECT_LE((high - low).maxCoeff(), most) << to_string(kind);
      EXPECT_GE((high - low).minCoeff(), least) << to_string(kind);
    }
  }
}

// Recordings of earlier versions go on being those of the same motion.
TEST(CameraPath, MotionsOfTheHandInTheOfficeStayWhatTheyWere) {
  const auto expect = [](PathKind kind, const Vector3d& position, const Vector3d& forward) {
    const Eigen::Isometry3d pose = CameraPath(kind, office(), 1).pose(3.0);
    EXPECT_LT((pose.translation() - position).norm(), 1e-12) << to_string(kind);
    EXPECT_LT((pose.linear().col(2) - forward).norm(), 1e-12) << to_string(kind);
  };
  expect(PathKind::fixed, {2.9999291914196955, 2.4537876815707556, 1.3761388665064738},
         {0.030653989964969052, 0.9639832041811199, -0.26419067916171635});
  expect(PathKind::xyz, {3.236539279826577, 2.375702792106422, 1.1495634813121918},
         {0.030653989964969052, 0.9639832041811199, -0.26419067916171635});
  expect(PathKind::halfsphere, {2.2667628428868043, 2.9053902155899904, 1.280123788126897},
         {0.4783328255791626, 0.8425286256821938, -0.24767564046455665});
  expect(PathKind::rpy, {2.971005814792809, 2.479992775351694, 1.3490236544351335},
         {0.08553339727230974, 0.9103997092915247, -0.40479180731947234});
}

TEST(CameraPath, SeedChangesTheMotionAndShakeScalesTheTremor) {
  const auto at = [](std::uint64_t seed, const PathStyle& style) -> Vector3d {
    return CameraPath(PathKind::fixed, office(), seed, style).pose(3).translation();
  };
  EXPECT_GT((CameraPath(PathKind::xyz, office(), 1).pose(3).translation() -
             CameraPath(PathKind::xyz, office(), 2).pose(3).translation())
                .norm(),
            0.01);
  EXPECT_EQ(at(1, steady), office().home);
  EXPECT_EQ(at(1, steady), at(2, steady));
  const Vector3d once = at(1, {}) - office().home, twice = at(1, {.shake = 2.0}) - office().home;
  EXPECT_GT(once.norm(), 1e-4);
  EXPECT_LT((twice - 2.0 * once).norm(), 1e-12);
}

TEST(CameraPath, TurnsAreAddedToTheMotion) {
  constexpr double degree = EIGEN_PI / 180.0;
  const CameraPath plain(PathKind::xyz, office(), 1, steady);
  const CameraPath turning(
      PathKind::xyz, office(), 1,
      {.shake = 0.0, .turns = {{2.0, 90 * degree, 300 * degree}, {4.0, -60 * degree, 100 * degree}}});
  double largest = 0.0;
  for (double time = 0.0; time < 6.0; time += 0.01) {
    const Eigen::Isometry3d before = plain.pose(time), after = turning.pose(time);
    EXPECT_LT((after.translation() - before.translation()).norm(), 1e-12);
    const Eigen::Matrix3d turn = after.linear() * before.linear().transpose();
    EXPECT_NEAR(turn(2, 2), 1.0, 1e-12) << "about the vertical";
    const double angle = std::atan2(turn(1, 0), turn(0, 0)) / degree;
    if (time < 2.0) {
      EXPECT_NEAR(angle, 0.0, 1e-9);
    }
    if (time > 2.46 && time < 4.0) {
      EXPECT_NEAR(angle, 90.0, 1e-9);
    }
    if (time > 4.91) {
      EXPECT_NEAR(angle, 30.0, 1e-9);
    }
    const Eigen::Matrix3d next = turning.pose(time + 0.001).linear() * plain.pose(time + 0.001).linear().transpose();
    largest = std::max(largest, Eigen::AngleAxisd(next * turn.transpose()).angle() / degree / 0.001);
  }
  EXPECT_NEAR(largest, 300.0, 5.0);
}

TEST(CameraPath, SpeedIsAFactorOnTheMotion) {
  for (const PathKind kind : {PathKind::xyz, PathKind::loop, PathKind::corridor, PathKind::table_edge}) {
    const CameraPath slow(kind, hall(), 1, steady), fast(kind, hall(), 1, {.speed = 2.0, .shake = 0.0});
    EXPECT_NEAR(fast.cycle(), 0.5 * slow.cycle(), 1e-9);
    // Half a second is lost at the start.
    for (const double time : {1.0, 4.0, 11.0})
      EXPECT_TRUE(fast.pose(time).isApprox(slow.pose(2.0 * time - 0.5), 1e-9)) << to_string(kind) << ' ' << time;
  }
}

TEST(CameraPath, RoundsComeBackToTheStart) {
  for (const std::string& room : room_names())
    for (const PathKind kind :
         {PathKind::loop, PathKind::corridor, PathKind::table_edge, PathKind::rotation, PathKind::square}) {
      const CameraPath path(kind, make_stage(room_kind(room)), 1, steady);
      for (const double time : {1.0, 3.3, 8.0}) {
        const Eigen::Isometry3d before = path.pose(time), after = path.pose(time + path.cycle());
        EXPECT_LT((before.translation() - after.translation()).norm(), 1e-6) << room << ' ' << to_string(kind);
        EXPECT_LT(angle_between(before, after), 1e-6) << room << ' ' << to_string(kind);
      }
    }
}

TEST(CameraPath, TheLoopOfTheHallIsLongAndRoundsTheRoom) {
  const CameraPath path(PathKind::loop, hall(), 1, steady);
  double way = 0.0, turned = 0.0;
  Eigen::AlignedBox3d bounds;
  for (double time = 2.0; time < 2.0 + path.cycle(); time += 0.05) {
    const Eigen::Isometry3d now = path.pose(time), next = path.pose(time + 0.05);
    way += (next.translation() - now.translation()).norm();
    turned += std::remainder(heading(next) - heading(now), 2.0 * std::numbers::pi);
    bounds.extend(now.translation());
  }
  EXPECT_GT(way, 26.0);
  EXPECT_LT(way, 30.0);
  EXPECT_NEAR(std::abs(turned), 2.0 * std::numbers::pi, 0.05);
  EXPECT_GT(bounds.sizes().x(), 7.5);
  EXPECT_GT(bounds.sizes().y(), 5.5);
}

TEST(CameraPath, TableEdgeSlidesSevenAndAHalfCentimetresAlongTheEdge) {
  const CameraPath path(PathKind::table_edge, hall(), 1, steady);
  Eigen::AlignedBox3d bounds;
  for (double time = 0; time < 2.0 * path.cycle(); time += 0.01) bounds.extend(path.pose(time).translation());
  EXPECT_NEAR(bounds.sizes().x(), 0.075, 1e-5);
  EXPECT_LT(bounds.sizes().y() + bounds.sizes().z(), 1e-12);
  EXPECT_TRUE(bounds.center().isApprox(hall().table_edge, 1e-4));
}

TEST(CameraPath, RotationTurnsFullyOnTheSpot) {
  const CameraPath path(PathKind::rotation, hall(), 1, steady);
  double turned = 0.0;
  for (double time = 1.0; time < 1.0 + path.cycle() - 1e-9; time += path.cycle() / 200) {
    turned += std::remainder(heading(path.pose(time + path.cycle() / 200)) - heading(path.pose(time)), 6.283185307);
    EXPECT_LT((path.pose(time).translation() - hall().spot).norm(), 0.15);
  }
  EXPECT_NEAR(std::abs(turned), 2.0 * std::numbers::pi, 1e-6);
}

TEST(CameraPath, SquareGoesRoundTheTableLookingAtIt) {
  const CameraPath path(PathKind::square, hall(), 1, steady);
  double round = 0.0;
  Vector3d before = path.pose(1.0).translation();
  for (double time = 1.0; time < 1.0 + path.cycle(); time += 0.1) {
    const Eigen::Isometry3d pose = path.pose(time);
    const Vector3d target = pose.inverse() * *hall().square.target;
    EXPECT_LT(target.head<2>().norm(), 1e-9);
    EXPECT_GT(target.z(), 0.8);
    const auto bearing = [&](const Vector3d& p) {
      return std::atan2(p.y() - hall().table.centre.y(), p.x() - hall().table.centre.x());
    };
    round += std::remainder(bearing(pose.translation()) - bearing(before), 2.0 * std::numbers::pi);
    before = pose.translation();
  }
  EXPECT_NEAR(std::abs(round), 2.0 * std::numbers::pi, 0.1);
}

TEST(WaypointPath, GoesToTheLastPlaceAndBackKeepingInsideTheCorners) {
  Waypoints way;
  way.places = {{1, 1, 1.4}, {4, 1, 1.4}, {4, 3, 1.6}};
  way.closed = false;
  way.aside = 0.5;
  const WaypointPath path(way);
  EXPECT_LT(path.length(), 5.02);
  EXPECT_GT(path.length(), 4.4);
  EXPECT_LT((path.pose(0).translation() - way.places[0]).norm(), 1e-6);
  const double there = path.length() / way.speed + 1.0;
  EXPECT_LT((path.pose(there).translation() - way.places[2]).norm(), 1e-6);
  EXPECT_LT((path.pose(path.cycle()).translation() - way.places[0]).norm(), 1e-6);
  EXPECT_NEAR(path.walked(path.cycle()), 2.0 * path.length(), 1e-9);
  for (double time = 0; time < path.cycle(); time += 0.05) {
    const Vector3d p = path.pose(time).translation();
    EXPECT_LE(p.x(), 4.0 + 1e-4);
    EXPECT_GE(p.y(), 1.0 - 1e-4);
    EXPECT_GE(p.y() - 1.0, p.x() - 4.0 - 1e-4);
  }
  // Looks to the left going there, and to the same side of the room coming back.
  EXPECT_NEAR(heading(path.pose(1.5)), 0.5, 0.02);
  EXPECT_NEAR(heading(path.pose(path.cycle() - 7.0)), std::numbers::pi - 0.5, 0.3);
}

TEST(WaypointPath, RefusesWhatIsNoWay) {
  Waypoints way;
  way.places = {{1, 1, 1}, {2, 1, 1}};
  EXPECT_THROW(WaypointPath{way}, ConfigurationError);
  way.closed = false;
  EXPECT_NO_THROW(WaypointPath{way});
  way.speed = 0.0;
  EXPECT_THROW(WaypointPath{way}, ConfigurationError);
  way.speed = 0.5;
  way.places.push_back(way.places.back());
  EXPECT_THROW(WaypointPath{way}, ConfigurationError);
}

TEST(CameraPath, LookAtPutsTheTargetOnTheOpticalAxisAndTheHorizonLevel) {
  const Eigen::Isometry3d T_world_camera = look_at({1, 2, 1.5}, {3, 4, 0.5});
  const Vector3d target = T_world_camera.inverse() * Vector3d(3, 4, 0.5);
  EXPECT_NEAR(target.x(), 0, 1e-12);
  EXPECT_NEAR(target.y(), 0, 1e-12);
  EXPECT_NEAR(target.z(), 3, 1e-12);
  EXPECT_NEAR(T_world_camera.linear().col(0).z(), 0, 1e-12);  // x is level
  EXPECT_LT(T_world_camera.linear().col(1).z(), 0);           // y points down
  EXPECT_NEAR(T_world_camera.linear().determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace holdfast::simulation
