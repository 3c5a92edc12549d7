// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/background.hpp"

#include <gtest/gtest.h>

#include "dense_map/wall_world.hpp"

namespace holdfast {
namespace {

using test::WallWorld;

DenseMapSettings fine_settings() {
  DenseMapSettings settings;
  settings.step = 1;
  settings.voxel_size = 0.02;
  return settings;
}

TEST(BackgroundPainter, ShowsTheWallBehindTheSquare) {
  WallWorld world;
  StaticScene scene(world.camera, fine_settings());
  world.show(scene, 0.0, 0.0, true);
  world.show(scene, 0.05, -0.9, true);
  world.show(scene, -0.05, 0.9, true);
  const BackgroundPicture picture = BackgroundPainter(scene, world.map).paint(0);
  EXPECT_EQ(picture.before.at<cv::Vec3b>(60, 80), cv::Vec3b(0, WallWorld::square_green, 0));
  EXPECT_EQ(picture.unknown, 0.0);
  EXPECT_NEAR(picture.replaced, 73.0 * 73.0 / (160.0 * 120.0), 0.01);  // with the edge of 4 px
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const Eigen::Vector3d point = scene.camera().back_project(x, y, WallWorld::wall_z);
      const cv::Vec3b wall = WallWorld::wall_colour(point.x(), point.y());
      const cv::Vec4b pixel = picture.after.at<cv::Vec4b>(y, x);
      ASSERT_EQ(pixel[3], 255) << x << " " << y;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], wall[c], 4) << x << " " << y;
    }
}

TEST(BackgroundPainter, SaysWhatNobodyKnows) {
  WallWorld world;
  StaticScene scene(world.camera, fine_settings());
  for (int i = 0; i < 3; ++i) world.show(scene, 0.0, 0.0, true);
  const BackgroundPicture picture = BackgroundPainter(scene, world.map).paint(1);
  EXPECT_GT(picture.unknown, 0.15);
  EXPECT_EQ(picture.after.at<cv::Vec4b>(60, 80), cv::Vec4b(255, 0, 255, 0));
  EXPECT_EQ(picture.after.at<cv::Vec4b>(5, 5)[3], 255);
}

TEST(BackgroundPainter, UsesNothingThatHasLeft) {
  WallWorld world;
  StaticScene scene(world.camera, fine_settings());
  // A square that no mask knows stands where, later, a masked one stands farther back in time's order.
  for (int i = 0; i < 2; ++i) world.show(scene, 0.0, 0.0, false);
  for (int i = 0; i < 4; ++i) world.show(scene, 0.02 * i, std::nullopt, true);
  world.show(scene, 0.0, 0.0, true);
  const BackgroundPainter painter(scene, world.map);
  // In the first view, too, where no mask names it.
  EXPECT_LT(painter.paint(0).after.at<cv::Vec4b>(60, 80)[1], 60);
  const BackgroundPicture picture = painter.paint(6);
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) ASSERT_EQ(picture.after.at<cv::Vec4b>(y, x)[1], 40) << x << " " << y;
}

TEST(BackgroundPainter, LetsTheNearerSurfaceHideTheFarther) {
  // The square as furniture: it must hide the wall behind it, though views that look past it show the wall there.
  WallWorld world;
  StaticScene scene(world.camera, fine_settings());
  world.show(scene, 0.0, 0.0, false);
  world.show(scene, 0.4, 0.0, false);
  const std::uint64_t index = world.keyframes.size();
  const KeyFrameId id = world.keyframe(0.05, index);
  cv::Mat labels(120, 160, CV_8UC1, cv::Scalar(1));  // somebody close covers all
  SensorFrame frame = world.images(0.05, index, 0.0);
  frame.depth.setTo(0.4F);
  scene.add(id, frame, {}, labels, {false, true});
  const BackgroundPicture picture = BackgroundPainter(scene, world.map).paint(2);
  int green = 0;
  for (int x = 50; x < 98; ++x) green += picture.after.at<cv::Vec4b>(60, x)[1] > 150 ? 1 : 0;
  EXPECT_GT(green, 44);
}

}  // namespace
}  // namespace holdfast
