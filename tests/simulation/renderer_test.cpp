// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/renderer.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "holdfast/simulation/camera_path.hpp"

namespace holdfast::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Blue rises with the column, green with the row.
cv::Mat ramp() {
  cv::Mat picture(240, 240, CV_8UC3);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x) picture.at<cv::Vec3b>(y, x) = cv::Vec3b(x + 8, y + 8, 100);
  return picture;
}

// A square of 4 m at y = 2, facing -y, its middle at the origin's height.
World one_wall() {
  World world;
  const TextureArea area = world.add_texture(ramp());
  Object& wall = world.objects.emplace_back();
  wall.class_name = wall.name = "wall";
  add_rectangle(wall.mesh, {-2, 2, 2}, {4, 0, 0}, {0, 0, -4}, area, 0.5F);
  return world;
}

class EveryCamera : public testing::TestWithParam<std::string> {};

TEST_P(EveryCamera, DepthAndColourAreThoseOfTheRawPixelsRay) {
  const Camera camera = *find_camera(GetParam());
  const World world = one_wall();
  Renderer renderer(world, camera);
  const Eigen::Isometry3d T_world_camera =
      look_at({0.2, 0.3, -0.1}, {0.0, 2.0, 0.1}) * Eigen::AngleAxisd(0.2, Vector3d::UnitZ());
  const RenderedFrame frame = renderer.render(T_world_camera, 0.0);
  ASSERT_EQ(frame.colour.size(), cv::Size(camera.width, camera.height));
  for (int y = 0; y < camera.height; y += 7)
    for (int x = 0; x < camera.width; x += 5) {
      const Vector2d pixel = camera.undistort({x, y});
      const Vector3d ray = T_world_camera.linear() * camera.back_project(pixel.x(), pixel.y(), 1.0);
      const double depth = (2.0 - T_world_camera.translation().y()) / ray.y();
      const Vector3d hit = T_world_camera.translation() + depth * ray;
      if (std::abs(hit.x()) > 1.9 || std::abs(hit.z()) > 1.9) continue;
      ASSERT_NEAR(frame.depth.at<float>(y, x), depth, 2e-6) << x << ' ' << y;
      ASSERT_EQ(frame.object_ids.at<std::uint16_t>(y, x), 1);
      const Vector3d direction = T_world_camera.translation() - hit;
      ASSERT_NEAR(frame.cosine.at<float>(y, x), -direction.y() / direction.norm(), 1e-4);
      const auto colour = frame.colour.at<cv::Vec3b>(y, x);
      ASSERT_NEAR(colour[0], (hit.x() + 2.0) * 60.0 + 7.5, 1.1) << x << ' ' << y;
      ASSERT_NEAR(colour[1], (2.0 - hit.z()) * 60.0 + 7.5, 1.1) << x << ' ' << y;
      ASSERT_NEAR(colour[2], 100, 1);
    }
}
INSTANTIATE_TEST_SUITE_P(Cameras, EveryCamera, testing::Values("tum_fr1", "tum_fr2", "tum_fr3", "kinect2"));

TEST(Renderer, EdgesLieWhereTheCameraSeesThem) {
  for (const char* name : {"tum_fr1", "tum_fr3"}) {
    const Camera camera = *find_camera(name);
    World world = one_wall();
    const TextureArea white = world.add_texture(cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(255)));
    Object& sheet = world.objects.emplace_back();
    sheet.class_name = sheet.name = "sheet";
    add_rectangle(sheet.mesh, {-0.3F, 1, 0.25F}, {0.6F, 0, 0}, {0, 0, -0.5F}, white, 0.2F);
    Renderer renderer(world, camera);
    const Eigen::Isometry3d T_world_camera = look_at({0.1, 0, 0.05}, {0.1, 1, 0.05});
    const RenderedFrame frame = renderer.render(T_world_camera, 0.0);
    const auto seen_at = [&](const Vector3d& point) {
      return camera.distort(camera.project(T_world_camera.inverse() * point));
    };
    const Vector2d left = seen_at({-0.3, 1, 0.05}), right = seen_at({0.3, 1, 0.05});
    const int row = static_cast<int>(std::lround(left.y()));
    for (int x = 5; x < camera.width - 5; ++x) {
      const bool inside = x > left.x() && x < right.x();
      const double border = std::min(std::abs(x - left.x()), std::abs(x - right.x()));
      if (border > 0.3) {
        EXPECT_EQ(frame.object_ids.at<std::uint16_t>(row, x), inside ? 2 : 1) << name << ' ' << x;
      }
    }
    // Smoothed edges: the white in the row adds up to the true width.
    double width = 0.0;
    for (int x = static_cast<int>(left.x()) - 5; x <= static_cast<int>(left.x()) + 5; ++x)
      width += (frame.colour.at<cv::Vec3b>(row, x)[2] - 100) / 155.0;
    EXPECT_NEAR(width, static_cast<int>(left.x()) + 5.5 - left.x(), 0.3) << name;
  }
}

TEST(Renderer, DrawsFloorThatPassesUnderTheCameraWithoutClippingErrors) {
  const Camera camera = *find_camera("tum_fr3");
  World world;
  Object& floor = world.objects.emplace_back();
  floor.class_name = floor.name = "floor";
  add_rectangle(floor.mesh, {-10, 10, 0}, {20, 0, 0}, {0, -20, 0}, world.add_texture(ramp()), 100.0F);
  Renderer renderer(world, camera);
  const Eigen::Isometry3d T_world_camera = look_at({0.3, 0.2, 1.0}, {0.3, 1.2, 0.2});
  const RenderedFrame frame = renderer.render(T_world_camera, 0.0);
  for (int y = 0; y < camera.height; y += 3)
    for (int x = 0; x < camera.width; x += 3) {
      const Vector3d ray = T_world_camera.linear() * camera.back_project(x, y, 1.0);
      const Vector3d hit = T_world_camera.translation() - 1.0 / ray.z() * ray;
      if (ray.z() > -0.15 || hit.cwiseAbs().maxCoeff() > 9.9) continue;
      ASSERT_NEAR(frame.depth.at<float>(y, x), -1.0 / ray.z(), 1e-5) << x << ' ' << y;
    }
}

TEST(Renderer, LeavesOutFacesThatAreTurnedAwayAndClosedBoxesHaveNoGaps) {
  const Camera camera = *find_camera("tum_fr3");
  World world;
  const TextureArea area = world.add_texture(ramp());
  Object& room = world.objects.emplace_back();
  room.class_name = room.name = "box";
  add_box(room.mesh, {Vector3f(-0.4F, 1.0F, -0.4F), Vector3f(0.4F, 1.8F, 0.4F)}, {area, area, area, area, area, area},
          0.07F);
  Renderer renderer(world, camera);
  // From inside every face is turned away.
  EXPECT_EQ(cv::countNonZero(renderer.render(look_at({0, 1.4, 0}, {0.1, 2, 0}), 0.0).depth), 0);
  // From outside the box covers one patch without holes: between the first and the last pixel of a row all is box.
  const RenderedFrame frame = renderer.render(look_at({0.9, 0, 0.8}, {0, 1.4, 0}), 0.0);
  int seen = 0;
  for (int y = 0; y < camera.height; ++y) {
    int first = -1, last = -1, count = 0;
    for (int x = 0; x < camera.width; ++x)
      if (frame.object_ids.at<std::uint16_t>(y, x) != 0) {
        if (first < 0) first = x;
        last = x, ++count;
      }
    if (count > 0) {
      ASSERT_EQ(count, last - first + 1) << "row " << y;
    }
    seen += count;
  }
  EXPECT_GT(seen, 20000);
}

TEST(Renderer, FollowsThingsThatMove) {
  World world = one_wall();
  const TextureArea area = world.add_texture(ramp());
  Object& box = world.objects.emplace_back();
  box.class_name = box.name = "box";
  add_box(box.mesh, {Vector3f(-0.1F, -0.1F, -0.1F), Vector3f(0.1F, 0.1F, 0.1F)}, {area, area, area, area, area, area});
  box.motion = [](double time) { return Eigen::Isometry3d(Eigen::Translation3d(0.2 * time, 1.0, 0.0)); };
  const Camera camera = *find_camera("icl_nuim");
  Renderer renderer(world, camera);
  for (const double time : {0.0, 1.0, 2.0}) {
    const RenderedFrame frame = renderer.render(look_at({0, 0, 0}, {0, 1, 0}), time);
    const Vector2d pixel = camera.project({0.2 * time, 0, 0.9});
    const cv::Point where(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    EXPECT_EQ(frame.object_ids.at<std::uint16_t>(where), 2);
    EXPECT_NEAR(frame.depth.at<float>(where), 0.9, 1e-5);
  }
}

}  // namespace
}  // namespace holdfast::simulation
