// SPDX-License-Identifier: BSD-3-Clause
#include "dense_cloud.hpp"

#include <gmock/gmock.h>

#include "viewer/socket_client.hpp"
#include "viewer/viewed_world.hpp"

namespace holdfast::viewer {
namespace {

using test::ReceivedMessage;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Points on a line along x, in the frame of the camera.
ViewedSurface row_surface(std::uint32_t keyframe, std::size_t points, float spacing = 0.1F) {
  ViewedSurface surface{test::keyframe_id(keyframe), static_cast<double>(keyframe), test::pose_at(keyframe), {}};
  for (std::size_t i = 0; i < points; ++i)
    surface.points.push_back({spacing * static_cast<float>(i) + 0.01F, 0.01F, 2.01F, 10, 20, 30});
  return surface;
}

ReceivedMessage told(const DenseCloud& cloud, CloudProgress& progress) {
  Message message;
  cloud.describe(progress, message);
  return ReceivedMessage(message.bytes());
}

TEST(DenseCloudTest, TellsEachSurfaceOnceInTheFrameOfItsKeyframe) {
  DenseCloud cloud;
  CloudProgress progress;
  EXPECT_FALSE(cloud.has_more(progress));
  cloud.add(row_surface(0, 2));
  ASSERT_TRUE(cloud.has_more(progress));
  const ReceivedMessage first = told(cloud, progress);
  EXPECT_EQ(first.json["new_cloud"], true);
  EXPECT_THAT(first.array<std::uint32_t>("surface_counts"), ElementsAre(2));
  EXPECT_THAT(first.array<float>("surface_poses"), ElementsAre(0, 0, 0, 0, 0, 0, 1));
  EXPECT_THAT(first.array<float>("surface_places"), SizeIs(6));
  EXPECT_THAT(first.array<std::uint8_t>("surface_colours"), ElementsAre(10, 20, 30, 10, 20, 30));
  EXPECT_FALSE(cloud.has_more(progress));

  cloud.add(row_surface(3, 1));
  const ReceivedMessage second = told(cloud, progress);
  EXPECT_FALSE(second.json.contains("new_cloud"));
  EXPECT_THAT(second.array<std::uint32_t>("surface_counts"), ElementsAre(1));
  EXPECT_EQ(second.array<float>("surface_poses")[0], 3.0F);
  EXPECT_FALSE(second.has("moved_surfaces"));
}

TEST(DenseCloudTest, HasOnePointForEachPlace) {
  DenseCloud cloud;
  cloud.add(row_surface(0, 5));
  cloud.add(row_surface(0, 7));  // the first five again
  EXPECT_EQ(cloud.size(), 7U);
  cloud.add(row_surface(0, 7));
  CloudProgress progress;
  EXPECT_THAT(told(cloud, progress).array<std::uint32_t>("surface_counts"), ElementsAre(5, 2));
}

TEST(DenseCloudTest, SurfacesFollowTheirKeyframes) {
  DenseCloud cloud;
  for (std::uint32_t i = 0; i < 3; ++i) cloud.add(row_surface(i, 1));
  CloudProgress progress;
  told(cloud, progress);
  ShownMap map;
  map.update(test::row_map(3), 1);
  cloud.follow(map, 1);
  EXPECT_FALSE(cloud.has_more(progress)) << "nothing has moved";

  MapSnapshot moved = test::row_map(3);
  moved.keyframes[2].T_world_camera = test::pose_at(2, 1);
  map.update(moved, 2);
  cloud.follow(map, 2);
  const ReceivedMessage message = told(cloud, progress);
  EXPECT_THAT(message.array<std::uint32_t>("moved_surfaces"), ElementsAre(2));
  EXPECT_THAT(message.array<float>("moved_surface_poses"), ElementsAre(2, 1, 0, 0, 0, 0, 1));
  EXPECT_FALSE(message.has("surface_counts"));
  EXPECT_FALSE(cloud.has_more(progress));

  // A keyframe that is gone: its surface follows the nearest one in time.
  moved.keyframes.erase(moved.keyframes.begin() + 1);
  moved.keyframes[0].T_world_camera = moved.keyframes[1].T_world_camera = test::pose_at(0, 5);
  map.update(moved, 3);
  cloud.follow(map, 3);
  EXPECT_THAT(told(cloud, progress).array<std::uint32_t>("moved_surfaces"), ElementsAre(0, 1, 2));
}

TEST(DenseCloudTest, StaysBelowItsBudgetByGrowingCoarser) {
  DenseCloud cloud;
  CloudProgress progress;
  for (std::uint32_t i = 0; i < 30; ++i) {
    ViewedSurface surface{test::keyframe_id(i), 0.0, Eigen::Isometry3d::Identity(), {}};
    for (int row = 0; row < 70; ++row)
      for (int column = 0; column < 70; ++column)
        surface.points.push_back(
            {0.021F * static_cast<float>(column), 0.021F * static_cast<float>(row), 2.0F * static_cast<float>(i)});
    cloud.add(std::move(surface));
    told(cloud, progress);
    EXPECT_LE(cloud.size(), DenseCloud::most_points);
  }
  EXPECT_GT(cloud.resolution(), DenseCloud::finest);
  EXPECT_GT(cloud.size(), DenseCloud::most_points / 4);
  // Whoever comes now gets it in several messages, and the same as who was there.
  CloudProgress late;
  std::size_t points = 0;
  int messages = 0;
  for (; late.number == 0 || cloud.has_more(late); ++messages) {
    const std::size_t count = told(cloud, late).array<float>("surface_places").size() / 3;
    EXPECT_LE(count, DenseCloud::most_in_message + 5000);
    points += count;
  }
  EXPECT_GT(messages, 1);
  EXPECT_EQ(points, cloud.size());
}

TEST(DenseCloudTest, AWholeCloudReplacesTheSurfacesAndFollowsNothing) {
  DenseCloud cloud;
  cloud.add(row_surface(0, 5));
  CloudProgress progress;
  told(cloud, progress);
  cloud.replace({{1, 2, 3, 4, 5, 6}});
  const ReceivedMessage message = told(cloud, progress);
  EXPECT_EQ(message.json["new_cloud"], true);
  EXPECT_THAT(message.array<float>("surface_places"), ElementsAre(1, 2, 3));
  ShownMap map;
  map.update(test::row_map(2), 1);
  MapSnapshot moved = test::row_map(2);
  moved.keyframes[0].T_world_camera = test::pose_at(0, 7);
  map.update(moved, 2);
  cloud.follow(map, 2);
  EXPECT_FALSE(cloud.has_more(progress));
}

}  // namespace
}  // namespace holdfast::viewer
