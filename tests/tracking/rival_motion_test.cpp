// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/rival_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "holdfast/tracking/image_depth.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

/// A camera that drove forward by a metre behind a vehicle, whose points have kept their place in the image. The
/// vehicle fills the middle of the image and has more features than the road around it.
class RoadAndVehicle {
 public:
  explicit RoadAndVehicle(double reach_of_vehicle = 120.0, std::uint32_t every_of_road = 8)
      : moving_world_({.camera = world_.camera()}, map_),
        context_({}, {world_.camera(), extractor_, depth_, optimizer_, detector_, moving_world_, map_}) {
    Frame& frame = context_.current;
    StageTimes stages;
    context_.builder.build(world_.frame(0, 0.0, Eigen::Isometry3d::Identity()), frame, stages);
    frame.static_probability.assign(frame.size(), 1.0F);
    const KeyFrameId keyframe = map_.add_keyframe(frame);
    on_vehicle_.resize(frame.size());
    for (std::uint32_t i = 0; i < frame.size(); ++i) {
      const double from_middle = std::max(std::abs(frame.x[i] - 320.0F), std::abs(frame.y[i] - 240.0F));
      on_vehicle_[i] = from_middle < reach_of_vehicle;
      if (!on_vehicle_[i] && i % every_of_road != 0) continue;
      const Eigen::Vector3d here = frame.camera_point(i);
      const MapPointId point = map_.add_point(on_vehicle_[i] ? here : driven().inverse() * here, 0);
      map_.add_observation(point, keyframe, i);
      map_.update_point(point);
      frame.map_points[i] = point;
    }
  }

  static Eigen::Isometry3d driven() { return Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, -1.0)); }
  int matches(bool on_vehicle) const {
    int count = 0;
    for (std::size_t i = 0; i < frame().size(); ++i)
      count += frame().map_points[i].valid() && on_vehicle_[i] == on_vehicle ? 1 : 0;
    return count;
  }
  /// The motion of the local map, after the adjustment went from one motion to another.
  bool test_from(const Eigen::Isometry3d& pose, std::optional<Eigen::Isometry3d> began = std::nullopt) {
    context_.current.T_camera_world = pose;
    context_.estimator.adjust(context_.current);
    return test_local_motion(context_, began.value_or(pose));
  }
  /// How many features have no weight, on the vehicle or the road.
  int moving(bool on_vehicle) const {
    int count = 0;
    for (std::size_t i = 0; i < frame().size(); ++i)
      count += frame().static_probability[i] == 0.0F && on_vehicle_[i] == on_vehicle ? 1 : 0;
    return count;
  }
  const Frame& frame() const { return context_.current; }
  double error() const { return (frame().T_camera_world.translation() - driven().translation()).norm(); }

 private:
  test::PointWorld world_{find_camera("tum_fr3").value()};
  test::PointExtractor extractor_{world_};
  ImageDepth depth_{world_.camera(), 0.0};
  test::PoseOptimizer optimizer_;
  test::BruteForceDetector detector_;
  Map map_;
  MovingWorld moving_world_;
  TrackingContext context_;
  std::vector<bool> on_vehicle_;
};

TEST(RivalMotion, TheRoadWinsAgainstAVehicleWithMoreFeatures) {
  RoadAndVehicle scene;
  const int road = scene.matches(false);
  ASSERT_GT(scene.matches(true), road);
  EXPECT_TRUE(scene.test_from(Eigen::Isometry3d::Identity()));
  EXPECT_LT(scene.error(), 0.01);
  EXPECT_EQ(scene.matches(true), 0);
  EXPECT_EQ(scene.matches(false), road);
}

TEST(RivalMotion, WhatMovesWithTheVehicleHasNoWeight) {
  for (const Eigen::Isometry3d& pose : {Eigen::Isometry3d::Identity(), RoadAndVehicle::driven()}) {
    RoadAndVehicle scene(120.0, 2);
    const int vehicle = scene.matches(true);
    scene.test_from(pose);
    EXPECT_GT(scene.moving(true), vehicle * 9 / 10);
    EXPECT_EQ(scene.moving(false), 0);
  }
}

// The vehicle is in more cells than the road, but not in half as many again.
TEST(RivalMotion, TheMotionOfThePredictionStays) {
  constexpr double reach = 190.0;
  EXPECT_FALSE(RoadAndVehicle(reach).test_from(Eigen::Isometry3d::Identity()));
  RoadAndVehicle scene(reach);
  EXPECT_TRUE(scene.test_from(Eigen::Isometry3d::Identity(), RoadAndVehicle::driven()));
  EXPECT_LT(scene.error(), 0.01);
  EXPECT_EQ(scene.matches(true), 0);
}

// The road is in more cells than the vehicle, but not in half as many again.
TEST(RivalMotion, WithoutAVelocityTheWiderMotionWins) {
  RoadAndVehicle scene(167.0, 4);
  ASSERT_GT(scene.matches(true), 2 * scene.matches(false));
  EXPECT_TRUE(scene.test_from(Eigen::Isometry3d::Identity()));
  EXPECT_LT(scene.error(), 0.01);
}

TEST(RivalMotion, AMuchNarrowerMotionIsLeft) {
  RoadAndVehicle scene(230.0);
  EXPECT_FALSE(scene.test_from(Eigen::Isometry3d::Identity(), RoadAndVehicle::driven()));
}

TEST(RivalMotion, TheRoadStays) {
  RoadAndVehicle scene(120.0, 1);
  ASSERT_GT(scene.matches(false), scene.matches(true));
  const std::vector<MapPointId> matches = scene.frame().map_points;
  EXPECT_FALSE(scene.test_from(RoadAndVehicle::driven()));
  EXPECT_LT(scene.error(), 0.01);
  EXPECT_EQ(scene.frame().map_points, matches);
}

TEST(RivalMotion, FewOutliersAreNoRival) {
  RoadAndVehicle scene(15.0);
  ASSERT_GT(scene.matches(true), 0);
  EXPECT_FALSE(scene.test_from(RoadAndVehicle::driven()));
}

}  // namespace
}  // namespace holdfast
