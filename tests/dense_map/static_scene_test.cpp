// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/static_scene.hpp"

#include <gmock/gmock.h>

#include <cstring>

#include "dense_map/wall_world.hpp"

namespace holdfast {
namespace {

using test::count_green;
using test::WallWorld;

DenseMapSettings small_settings() {
  DenseMapSettings settings;
  settings.voxel_size = 0.02;
  return settings;
}

TEST(StaticScene, PutsTheWallWhereItIs) {
  WallWorld world(0.1);
  StaticScene scene(world.camera, small_settings());
  for (int i = 0; i < 4; ++i) world.show(scene, 0.1 * i, std::nullopt, true);
  const std::vector<CloudPoint> cloud = scene.cloud(world.map);
  // The wall that two views share is about 2.4 m x 1.7 m; voxels of 2 cm.
  EXPECT_GT(cloud.size(), 6000U);
  EXPECT_LT(cloud.size(), 14000U);
  for (const CloudPoint& point : cloud) {
    ASSERT_NEAR(point.z, WallWorld::wall_z, KeptView::depth_unit);
    const cv::Vec3b colour = WallWorld::wall_colour(point.x, point.y);
    ASSERT_NEAR(point.blue, colour[0], 3);
    ASSERT_NEAR(point.red, colour[2], 3);
    ASSERT_EQ(point.green, 40);
  }
}

TEST(StaticScene, GivesTheSurfaceOfAView) {
  WallWorld world;
  StaticScene scene(world.camera, small_settings());
  world.show(scene, 0.3, 0.3, true);
  const KeptView& view = scene.views().front();  // 80 x 60 pixels, a part of them on the square
  const std::vector<CloudPoint> all = scene.surface(view, 80 * 60);
  EXPECT_GT(all.size(), 2000U);
  EXPECT_LT(all.size(), 4500U);
  EXPECT_EQ(count_green(all), 0);
  for (const CloudPoint& point : all) {
    ASSERT_NEAR(point.z, WallWorld::wall_z, KeptView::depth_unit);
    const cv::Vec3b colour = WallWorld::wall_colour(point.x + 0.3, point.y);
    ASSERT_NEAR(point.blue, colour[0], 3);
    ASSERT_NEAR(point.red, colour[2], 3);
  }
  for (const std::size_t most : {std::size_t{1000}, std::size_t{100}, std::size_t{1}}) {
    EXPECT_LE(scene.surface(view, most).size(), most);
    if (most > 1) {
      EXPECT_GT(scene.surface(view, most).size(), most / 4);
    }
  }
}

TEST(StaticScene, FollowsThePosesThatTheMapHasAtTheEnd) {
  WallWorld world;
  StaticScene scene(world.camera, small_settings());
  for (int i = 0; i < 3; ++i) world.show(scene, 0.1 * i, std::nullopt, true);
  Eigen::Isometry3d T_new_world = Eigen::Isometry3d::Identity();
  T_new_world.translation().z() = 5.0;
  for (const KeyFrameId id : world.keyframes) {
    Frame& frame = world.map.keyframe(id).frame;
    frame.T_camera_world = frame.T_camera_world * T_new_world.inverse();
  }
  const auto cloud = scene.cloud(world.map);
  ASSERT_GT(cloud.size(), 1000U);
  for (const CloudPoint& point : cloud) ASSERT_NEAR(point.z, WallWorld::wall_z + 5.0, 1e-3);
}

TEST(StaticScene, PlacesKeyframesThatTheMapRemoved) {
  WallWorld world;
  StaticScene scene(world.camera, small_settings());
  for (int i = 0; i < 3; ++i) world.show(scene, 0.1 * i, std::nullopt, true);
  const auto before = scene.cloud(world.map);
  world.map.keyframe(world.keyframes[1]).parent = world.keyframes[0];
  world.map.keyframe(world.keyframes[0]).children.push_back(world.keyframes[1]);
  world.map.remove_keyframe(world.keyframes[1]);
  const auto after = scene.cloud(world.map);
  EXPECT_NEAR(static_cast<double>(after.size()), static_cast<double>(before.size()), before.size() * 0.01);
}

TEST(StaticScene, LeavesOutWhatIsMasked) {
  WallWorld world;
  StaticScene scene(world.camera, small_settings());
  for (int i = 0; i < 4; ++i) world.show(scene, 0.05 * i, 0.0, true);
  const auto cloud = scene.cloud(world.map);
  EXPECT_GT(cloud.size(), 3000U);
  EXPECT_EQ(count_green(cloud), 0);
}

TEST(StaticScene, ForgetsWhatLeftAndKeepsWhatStayed) {
  WallWorld world;
  StaticScene moving(world.camera, small_settings());
  // Slow enough to be seen twice in a place.
  for (int i = 0; i < 10; ++i) world.show(moving, 0.0, -0.6 + 0.06 * i, false);
  for (int i = 0; i < 3; ++i) world.show(moving, 0.0, std::nullopt, false);
  EXPECT_EQ(count_green(moving.cloud(world.map)), 0);

  WallWorld arriving;
  StaticScene arrived(arriving.camera, small_settings());
  for (int i = 0; i < 6; ++i) arriving.show(arrived, 0.0, std::nullopt, false);
  for (int i = 0; i < 3; ++i) arriving.show(arrived, 0.0, 0.0, false);
  EXPECT_GT(count_green(arrived.cloud(arriving.map)), 300);

  WallWorld leaving;
  StaticScene left(leaving.camera, small_settings());
  for (int i = 0; i < 8; ++i) leaving.show(left, 0.0, 0.0, false);
  EXPECT_GT(count_green(left.cloud(leaving.map)), 300);
  for (int i = 0; i < 3; ++i) leaving.show(left, 0.0, std::nullopt, false);
  EXPECT_EQ(count_green(left.cloud(leaving.map)), 0);
}

TEST(StaticScene, NeedsEnoughViews) {
  WallWorld world;
  DenseMapSettings settings = small_settings();
  settings.minimum_views = 3;
  StaticScene scene(world.camera, settings);
  for (int i = 0; i < 2; ++i) world.show(scene, 0.0, std::nullopt, true);
  EXPECT_TRUE(scene.cloud(world.map).empty());
  world.show(scene, 0.0, std::nullopt, true);
  EXPECT_FALSE(scene.cloud(world.map).empty());
}

TEST(StaticScene, KeepsABoundedNumberOfViewsSpreadInTime) {
  WallWorld world;
  DenseMapSettings settings = small_settings();
  settings.keyframes = 5;
  StaticScene scene(world.camera, settings);
  for (int i = 0; i < 33; ++i) world.show(scene, 0.01 * i, std::nullopt, true);
  ASSERT_EQ(scene.views().size(), 5U);
  EXPECT_EQ(scene.views().front().frame_index, 0U);
  EXPECT_EQ(scene.views().back().frame_index, 32U);
  std::uint64_t widest = 0;
  for (std::size_t i = 1; i < 5; ++i)
    widest = std::max(widest, scene.views()[i].frame_index - scene.views()[i - 1].frame_index);
  EXPECT_LE(widest, 17U);
  EXPECT_EQ(scene.view_bytes(), 80U * 60U * 5U);
  EXPECT_EQ(StaticScene(world.camera, settings, true).view_bytes(), 80U * 60U * 6U);
}

TEST(StaticScene, DoesNotDependOnTheOrderInWhichMasksCome) {
  WallWorld world;
  StaticScene in_order(world.camera, small_settings()), late(world.camera, small_settings());
  for (int i = 0; i < 4; ++i) world.show(in_order, 0.1 * i, 0.3, false);
  for (const int i : {1, 0, 3, 2})
    late.add(world.keyframes[static_cast<std::size_t>(i)], world.images(0.1 * i, static_cast<std::uint64_t>(i), 0.3),
             {}, {}, {});
  EXPECT_EQ(in_order.cloud(world.map), late.cloud(world.map));
}

TEST(CloudPly, HoldsWhatItsHeaderSays) {
  const std::vector<CloudPoint> cloud{{1.5F, -2.0F, 3.25F, 10, 20, 30}, {0.0F, 0.5F, 1.0F, 255, 0, 1}};
  const std::string text = cloud_ply(cloud);
  EXPECT_THAT(text, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, testing::HasSubstr("element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                                       "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"));
  const std::size_t start = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size() - start, 2U * 15U);
  float y = 0.0F;
  std::memcpy(&y, text.data() + start + 4, 4);
  EXPECT_EQ(y, -2.0F);
  EXPECT_EQ(static_cast<unsigned char>(text[start + 14]), 30);
  EXPECT_EQ(static_cast<unsigned char>(text[start + 15 + 12]), 255);
}

}  // namespace
}  // namespace holdfast
