// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/road.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "support/same_bytes.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Scene road_scene(RoadKind kind, std::uint64_t seed = 1, double duration = 0.5) {
  Scene scene;
  scene.road = RoadPlan{.kind = kind};
  scene.camera.path = PathKind::drive;
  scene.seed = seed;
  scene.duration = duration;
  scene.frame_rate = 10.0;
  scene.colour_sensor.noise = 0.0;
  return scene;
}

Camera small_road_camera() {
  Camera camera = *find_camera("kitti_00");
  camera.width /= 4, camera.height /= 4;
  camera.fx /= 4.0, camera.fy /= 4.0, camera.cx /= 4.0, camera.cy /= 4.0;
  return camera;
}

class Road : public testing::TestWithParam<RoadKind> {};

TEST_P(Road, HasALineWithItsTangentAndACarThatFollowsIt) {
  const RoadPlan plan{.kind = GetParam()};
  const RoadCourse course(plan, 5);
  constexpr double step = 1e-4;
  for (const double x : {-40.0, 0.0, 333.0, 1900.0}) {
    const Vector3d along = course.frame(x + step).translation() - course.frame(x - step).translation();
    EXPECT_LT((along.normalized() - course.frame(x).linear().col(0)).norm(), 1e-6) << x;
    EXPECT_NEAR((course.frame(x, -3.0).translation() - course.frame(x).translation()).norm(), 3.0, 1e-9);
  }
  EXPECT_NEAR(course.driven(26.0), 26.0 * plan.mean_speed(), 1e-6) << "two periods of the speed";
  const CameraPath path(plan, 5);
  for (double time = 0.0; time < 30.0; time += 0.7) {
    const Vector3d eye = path.pose(time).translation();
    const Vector3d local = course.frame(eye.x(), course.lane()).inverse() * eye;
    EXPECT_NEAR(local.z(), 1.65, 0.05);
    EXPECT_NEAR(local.y(), 0.0, 0.3);
    EXPECT_GT(path.pose(time).linear().col(2).dot(course.frame(eye.x()).linear().col(0)), 0.999);
    EXPECT_NEAR((path.pose(time + 0.1).translation() - eye).norm(), 0.1 * plan.mean_speed(), 0.012 * plan.mean_speed());
  }
}

// Static points of a frame, moved by the true poses, are where the next frame and the right image see them.
TEST_P(Road, DepthPosesAndThePairAgree) {
  Simulator simulator(road_scene(GetParam()), small_road_camera());
  const Camera& camera = simulator.camera();
  const RenderedFrame first = simulator.render(0), second = simulator.render(1);
  const SensorFrame pair = simulator.stereo_frame(0, 0.54);
  const cv::Mat& moving = pair.truth->object_mask;
  const Isometry3d T_second_first = simulator.T_world_camera(1).inverse() * simulator.T_world_camera(0);
  int seen = 0, agree = 0, in_right = 0, like_right = 0;
  for (int y = 2; y < camera.height - 2; y += 2)
    for (int x = 2; x < camera.width - 2; x += 2) {
      const double depth = first.depth.at<float>(y, x);
      if (depth <= 0.0 || depth > 60.0 || moving.at<std::uint8_t>(y, x) != 0) continue;
      const Vector3d point = camera.back_project(x, y, depth), moved = T_second_first * point;
      if (moved.z() > 1.0) {
        const Vector2d pixel = camera.project(moved);
        const auto column = std::lround(pixel.x()), row = std::lround(pixel.y());
        if (column >= 0 && row >= 0 && column < camera.width && row < camera.height) {
          ++seen;
          const double there = second.depth.at<float>(static_cast<int>(row), static_cast<int>(column));
          agree += std::abs(there - moved.z()) < 0.06 * moved.z();
        }
      }
      const long right = std::lround(x - camera.fx * 0.54 / depth);
      if (right < 0) continue;
      ++in_right;
      const cv::Vec3b left_colour = pair.colour.at<cv::Vec3b>(y, x);
      const cv::Vec3b right_colour = pair.right.at<cv::Vec3b>(y, static_cast<int>(right));
      like_right += std::abs(left_colour[1] - right_colour[1]) < 25;
    }
  EXPECT_GT(seen, 2000);
  EXPECT_GT(agree, 0.85 * seen);  // the others are hidden, or at thin rails
  EXPECT_GT(like_right, 0.8 * in_right);
}

TEST_P(Road, TrafficKeepsItsLanesAndDistances) {
  const SceneWorld road = make_scene_world(road_scene(GetParam(), 2, 5.0));
  const CameraPath path = make_path(road_scene(GetParam(), 2, 5.0), road.stage);
  const RoadCourse course(RoadPlan{.kind = GetParam()}, 2);
  ASSERT_GE(road.numbered.size(), 10U);
  bool own_lane = false, oncoming = false;
  for (double time = 0.0; time < 40.0; time += 0.5) {
    const Vector3d eye = path.pose(time).translation();
    std::vector<Vector2d> places;
    for (const NumberedObject& numbered : road.numbered) {
      const Object& vehicle = road.world.objects[numbered.index];
      const Isometry3d pose = vehicle.pose(time);
      const Vector3d place = pose.translation();
      const double left = (course.frame(place.x()).inverse() * place).y();
      const bool is_own = std::abs(left - course.lane()) < 1.0;
      if (is_own) {
        EXPECT_GT(place.x() - eye.x(), 7.0) << vehicle.name << ", " << time << " s";
      }
      own_lane = own_lane || is_own;
      oncoming = oncoming || (left > 0.0 && pose.linear()(0, 0) < -0.9);
      EXPECT_LT(place.x() - eye.x(), 430.0);
      for (const Vector2d& other : places)
        EXPECT_GT((other - place.head<2>()).norm(), 2.5) << vehicle.name << ", " << time << " s";
      places.emplace_back(place.head<2>());
    }
  }
  EXPECT_TRUE(own_lane && oncoming);
}

TEST_P(Road, SameSeedSameBytesAndLongerDrivesHaveTheSameStretches) {
  const Camera camera = small_road_camera();
  Simulator one(road_scene(GetParam(), 3), camera), again(road_scene(GetParam(), 3), camera),
      other(road_scene(GetParam(), 4), camera), longer(road_scene(GetParam(), 3, 4.0), camera);
  const SensorFrame frame = one.stereo_frame(4, 0.54), same = again.stereo_frame(4, 0.54);
  EXPECT_TRUE(test::same_bytes(frame.colour, same.colour));
  EXPECT_TRUE(test::same_bytes(frame.right, same.right));
  EXPECT_FALSE(test::same_bytes(frame.colour, other.stereo_frame(4, 0.54).colour));
  const cv::Mat depth = one.render(4).depth, of_longer = longer.render(4).depth;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      if (const float here = depth.at<float>(y, x); here < 300.0F) {
        ASSERT_EQ(here, of_longer.at<float>(y, x)) << x << ", " << y;
      }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Road, testing::Values(RoadKind::street, RoadKind::motorway),
                         [](const auto& kind) { return to_string(kind.param); });

TEST(RoadDrive, WithoutAnEndIsRefused) {
  Scene scene = road_scene(RoadKind::motorway, 1, 3600.0);
  scene.file = "far.yaml";
  try {
    make_scene_world(scene);
    ADD_FAILURE() << "a road of 90 km was built";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("far.yaml"), testing::HasSubstr("at most 20000 m")));
  }
}

}  // namespace
}  // namespace holdfast::simulation
