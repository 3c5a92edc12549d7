// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/simulator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/error.hpp"
#include "support/same_bytes.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Scene scene_of(PathKind path, std::uint64_t seed = 1) {
  Scene scene;
  scene.camera.path = path;
  scene.seed = seed;
  scene.duration = 4.0;
  return scene;
}

template <class T>
T median(std::vector<T> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(Simulator, SameSeedSameBytesInAnyOrder) {
  const Camera camera = *find_camera("tum_fr1");
  Simulator first(scene_of(PathKind::halfsphere), camera), second(scene_of(PathKind::halfsphere), camera);
  const SensorFrame early = first.frame(5), late = first.frame(80);
  const SensorFrame late_again = second.frame(80), early_again = second.frame(5);
  EXPECT_TRUE(test::same_bytes(early.colour, early_again.colour));
  EXPECT_TRUE(test::same_bytes(early.depth, early_again.depth));
  EXPECT_TRUE(test::same_bytes(late.colour, late_again.colour));
  EXPECT_TRUE(test::same_bytes(late.depth, late_again.depth));
  EXPECT_EQ(early.truth->T_world_camera->matrix(), early_again.truth->T_world_camera->matrix());
  EXPECT_FALSE(test::same_bytes(early.depth, late.depth));

  Simulator other(scene_of(PathKind::halfsphere, 2), camera);
  EXPECT_FALSE(test::same_bytes(other.render(5).colour, first.render(5).colour));
}

TEST(Simulator, FramesCarryTimeTruthAndLabels) {
  Simulator simulator(scene_of(PathKind::xyz), *find_camera("tum_fr3"));
  ASSERT_EQ(simulator.frame_count(), 120U);
  const SensorFrame frame = simulator.frame(33);
  EXPECT_EQ(frame.index, 33U);
  EXPECT_DOUBLE_EQ(frame.timestamp, 1.1);
  EXPECT_EQ(frame.colour.type(), CV_8UC3);
  EXPECT_EQ(frame.depth.type(), CV_32FC1);
  ASSERT_TRUE(frame.truth && frame.truth->T_world_camera);
  const Trajectory truth = simulator.truth();
  ASSERT_EQ(truth.size(), 120U);
  EXPECT_EQ(truth[33].timestamp, frame.timestamp);
  EXPECT_TRUE(truth[33].T_world_camera.isApprox(*frame.truth->T_world_camera, 1e-12));
  EXPECT_EQ(cv::countNonZero(frame.truth->object_mask), 0);  // nothing moves

  const std::vector<std::string>& names = simulator.class_names();
  const auto label = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  for (const char* name : {"desk", "wall", "monitor", "floor"}) {
    ASSERT_LT(label(name), static_cast<long>(names.size())) << name;
    EXPECT_GT(cv::countNonZero(frame.truth->class_labels == label(name)), 1000) << name;
  }
  EXPECT_EQ(cv::countNonZero(frame.truth->class_labels == 0), 0);  // the room is closed
  EXPECT_GT(cv::countNonZero(frame.depth), 0.85 * 640 * 480);
  EXPECT_LT(cv::countNonZero(frame.depth), 0.999 * 640 * 480);

  Scene nothing;
  nothing.duration = 0.0;
  EXPECT_THROW(Simulator(nothing, Camera()), ConfigurationError);
}

// Depth and colour of one frame, taken to another by the true poses, must be found there.
TEST(Simulator, DepthColourAndPosesAgreeBetweenFrames) {
  const Camera camera = *find_camera("tum_fr1");
  for (const PathKind path : {PathKind::xyz, PathKind::rpy}) {
    Simulator simulator(scene_of(path), camera);
    const std::uint64_t one = 40, other = 70;
    const RenderedFrame from = simulator.render(one), to = simulator.render(other);
    const Eigen::Isometry3d T_to_from = simulator.T_world_camera(other).inverse() * simulator.T_world_camera(one);
    cv::Mat grey_from, grey_to;
    cv::cvtColor(from.colour, grey_from, cv::COLOR_BGR2GRAY);
    cv::cvtColor(to.colour, grey_to, cv::COLOR_BGR2GRAY);
    std::vector<double> depth_errors, colour_errors;
    for (int y = 0; y < camera.height; y += 2)
      for (int x = 0; x < camera.width; x += 2) {
        const Vector2d pixel = camera.undistort({x, y});
        const Vector3d point = T_to_from * camera.back_project(pixel.x(), pixel.y(), from.depth.at<float>(y, x));
        if (point.z() < 0.1) continue;
        const Vector2d raw = camera.distort(camera.project(point));
        const int u = static_cast<int>(std::lround(raw.x())), v = static_cast<int>(std::lround(raw.y()));
        if (u < 1 || v < 1 || u >= camera.width - 1 || v >= camera.height - 1) continue;
        // The warped point falls between pixels: compare with the surface there, at the same object.
        if (from.object_ids.at<std::uint16_t>(y, x) != to.object_ids.at<std::uint16_t>(v, u)) continue;
        depth_errors.push_back(std::abs(to.depth.at<float>(v, u) - point.z()));
        cv::Mat patch;
        cv::getRectSubPix(grey_to, {1, 1}, cv::Point2f(static_cast<float>(raw.x()), static_cast<float>(raw.y())),
                          patch);
        colour_errors.push_back(
            std::abs(static_cast<double>(patch.at<std::uint8_t>(0)) - grey_from.at<std::uint8_t>(y, x)));
      }
    ASSERT_GT(depth_errors.size(), 20000U);
    EXPECT_LT(median(depth_errors), 0.002) << to_string(path);
    EXPECT_LT(median(colour_errors), 4.0) << to_string(path);
  }
}

double distance_to_triangle(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const double height = std::abs(normal.dot(point - a));
  double outside = 0.0;
  for (const auto& [from, to] : {std::pair(a, b), {b, c}, {c, a}})
    outside = std::max(outside, -normal.dot((to - from).normalized().cross(point - from)));
  return std::max(height, outside);
}

TEST(Simulator, EveryPixelLiesOnTheSurfaceOfItsObject) {
  const Camera camera = *find_camera("tum_fr1");
  Simulator simulator(scene_of(PathKind::halfsphere), camera);
  const std::uint64_t index = 100;
  const RenderedFrame frame = simulator.render(index);
  const Eigen::Isometry3d T_world_camera = simulator.T_world_camera(index);
  for (int y = 3; y < camera.height; y += 16)
    for (int x = 3; x < camera.width; x += 16) {
      const int id = frame.object_ids.at<std::uint16_t>(y, x);
      ASSERT_GT(id, 0) << x << ' ' << y;
      const Object& object = simulator.world().objects[static_cast<std::size_t>(id) - 1];
      const Vector2d pixel = camera.undistort({x, y});
      const double depth = frame.depth.at<float>(y, x);
      const Vector3d point = object.pose(simulator.timestamp(index)).inverse() *
                             (T_world_camera * camera.back_project(pixel.x(), pixel.y(), depth));
      double nearest = 1e9;
      for (const Triangle& triangle : object.mesh.triangles) {
        const auto corner = [&](std::uint32_t i) -> Vector3d {
          return object.mesh.vertices[i].position.cast<double>();
        };
        nearest =
            std::min(nearest, distance_to_triangle(point, corner(triangle.a), corner(triangle.b), corner(triangle.c)));
      }
      // Up to a quarter of a pixel beyond an edge, which is 0.5 mm at 1 m; more where it is seen flat.
      const double pixel_size = depth / camera.fx / std::max(0.1F, frame.cosine.at<float>(y, x));
      EXPECT_LT(nearest, 1e-4 + 0.4 * pixel_size) << object.name << " at " << x << ' ' << y;
    }
}

// tum_fr1_xyz has a median of 1575 FAST corners (threshold 20) and 68 % of 80 px cells with at least five.
TEST(Simulator, OffersAsManyCornersAsARealDesk) {
  const Camera camera = *find_camera("tum_fr1");
  for (const PathKind path : {PathKind::xyz, PathKind::halfsphere}) {
    Simulator simulator(scene_of(path, 3), camera);
    for (const std::uint64_t index : {0, 60, 119}) {
      cv::Mat grey;
      cv::cvtColor(simulator.frame(index).colour, grey, cv::COLOR_BGR2GRAY);
      std::vector<cv::KeyPoint> corners;
      cv::FAST(grey, corners, 20);
      EXPECT_GT(corners.size(), 788U) << to_string(path) << ' ' << index;
      EXPECT_LT(corners.size(), 3150U) << to_string(path) << ' ' << index;
      int cells[6][8] = {}, filled = 0;
      for (const cv::KeyPoint& corner : corners)
        ++cells[static_cast<int>(corner.pt.y) / 80][static_cast<int>(corner.pt.x) / 80];
      for (const auto& row : cells)
        for (const int count : row) filled += count >= 5;
      EXPECT_GE(filled, 30) << to_string(path) << ' ' << index;
    }
  }
}

}  // namespace
}  // namespace holdfast::simulation
