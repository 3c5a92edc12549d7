// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/warp.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::geometry {
namespace {

const Pinhole narrow{520.0, 515.0, 318.0, 242.0}, wide{300.0, 305.0, 160.0, 120.0};

Eigen::Isometry3d small_motion() {
  Vector6d tangent;
  tangent << 0.1, -0.05, 0.2, 0.02, -0.03, 0.04;
  return exp_se3(tangent);
}

TEST(Warp, AgreesWithProjectionInDoublePrecision) {
  const Eigen::Isometry3d T_to_from = small_motion();
  const Warp warp(T_to_from, narrow, wide);
  for (const float x : {10.0F, 318.0F, 600.0F})
    for (const float y : {20.0F, 242.0F, 470.0F})
      for (const float depth : {0.4F, 1.5F, 6.0F}) {
        const Eigen::Vector3d point = T_to_from * narrow.back_project(x, y, depth);
        const Eigen::Vector2d pixel = wide.project(point);
        const auto warped = warp(warp.ray_x(x), warp.ray_y(y), depth);
        ASSERT_TRUE(warped);
        EXPECT_LT((warped->point.cast<double>() - point).norm(), 1e-6 * depth);
        EXPECT_NEAR(warped->x, pixel.x(), 1e-3);
        EXPECT_NEAR(warped->y, pixel.y(), 1e-3);
      }
}

TEST(Warp, LeadsBackAgain) {
  const Eigen::Isometry3d T_to_from = small_motion();
  const Warp there(T_to_from, narrow, wide), back(T_to_from.inverse(), wide, narrow);
  const auto warped = there(there.ray_x(100.0F), there.ray_y(300.0F), 2.0F);
  ASSERT_TRUE(warped);
  const auto again = back(back.ray_x(warped->x), back.ray_y(warped->y), warped->point.z());
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->x, 100.0F, 1e-2);
  EXPECT_NEAR(again->y, 300.0F, 1e-2);
  EXPECT_NEAR(again->point.z(), 2.0F, 1e-5);
}

TEST(Warp, ARowHasTheBitsOfItsPixels) {
  for (const double back : {0.0, 1.5}) {
    Eigen::Isometry3d T_to_from = small_motion();
    T_to_from.translation().z() -= back;
    const Warp warp(T_to_from, narrow, wide, 0.2F);
    constexpr int count = 37;  // no multiple of a vector's length
    Eigen::ArrayXf rays_x(count), depth(count);
    for (int i = 0; i < count; ++i) {
      rays_x[i] = warp.ray_x(static_cast<float>(17 * i));
      depth[i] = i % 5 == 0 ? 0.0F : 0.3F + 0.07F * static_cast<float>(i);
    }
    WarpedRow row;
    warp.row(rays_x, warp.ray_y(123.0F), depth, row);
    int visible = 0;
    for (int i = 0; i < count; ++i) {
      if (depth[i] == 0.0F) continue;
      const auto warped = warp(rays_x[i], warp.ray_y(123.0F), depth[i]);
      ASSERT_EQ(warped.has_value(), warp.is_visible(row.z[i])) << i;
      if (!warped) continue;
      ++visible;
      EXPECT_EQ(warped->point.z(), row.z[i]) << i;
      EXPECT_EQ(warped->x, row.x[i]) << i;
      EXPECT_EQ(warped->y, row.y[i]) << i;
    }
    EXPECT_EQ(visible == 29, back == 0.0) << visible;
  }
}

TEST(Warp, PointsBehindOrTooNearHaveNoPixel) {
  Eigen::Isometry3d T_to_from = Eigen::Isometry3d::Identity();
  T_to_from.translation().z() = -1.0;  // the second camera stands one metre ahead
  const Warp warp(T_to_from, narrow, 0.3F);
  EXPECT_FALSE(warp(0.0F, 0.0F, 0.5F));
  EXPECT_FALSE(warp(0.0F, 0.0F, 1.25F));
  EXPECT_TRUE(warp(0.0F, 0.0F, 1.35F));
  EXPECT_FALSE(warp.project({0.0F, 0.0F, 0.29F}));
}

TEST(Warp, DirectionsFollowTheRotationAlone) {
  const Warp still(Eigen::Isometry3d::Identity(), narrow), moved(small_motion(), narrow);
  const Eigen::Vector3d ray((400.0 - narrow.cx) / narrow.fx, (200.0 - narrow.cy) / narrow.fy, 1.0);
  const Eigen::Vector2d expected = narrow.project(small_motion().linear() * ray);
  const auto direction = moved.project_direction(still.ray_x(400.0F), still.ray_y(200.0F));
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->x, expected.x(), 1e-3);
  EXPECT_NEAR(direction->y, expected.y(), 1e-3);
}

TEST(SeenThrough, NeedsSixFartherCellsAndNoNearerOne) {
  const std::vector<float> wall(9, 3.0F);
  EXPECT_TRUE(is_seen_through(wall, 3, 4, 2.5F));
  EXPECT_TRUE(is_seen_through(wall, 3, 4, 3.0F));
  EXPECT_FALSE(is_seen_through(wall, 3, 4, 3.1F));
  std::vector<float> holes = wall;
  holes[0] = holes[1] = holes[2] = 0.0F;
  EXPECT_TRUE(is_seen_through(holes, 3, 4, 2.5F));
  holes[3] = 0.0F;
  EXPECT_FALSE(is_seen_through(holes, 3, 4, 2.5F)) << "five farther cells";
  std::vector<float> edge = wall;
  edge[8] = 2.0F;
  EXPECT_FALSE(is_seen_through(edge, 3, 4, 2.5F)) << "a depth edge";
}

}  // namespace
}  // namespace holdfast::geometry
