// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "geometry/synthetic.hpp"
#include "holdfast/geometry/epipolar.hpp"
#include "holdfast/geometry/triangulation.hpp"

namespace holdfast::geometry {
namespace {

struct TwoViews {
  Camera camera = synthetic::camera();
  Eigen::Isometry3d T_a_world, T_b_world;
  std::vector<Eigen::Vector3d> points;

  explicit TwoViews(std::uint64_t seed) {
    Random random(seed);
    T_a_world = exp_se3(synthetic::tangent(random, 0.5, 0.4));
    Vector6d between = synthetic::tangent(random, 0.05, 0.05);
    between[0] -= 0.3;
    T_b_world = exp_se3(between) * T_a_world;
    for (int i = 0; i < 50; ++i) {
      const double x = random.uniform(150, 500), y = random.uniform(50, 400);
      points.push_back(T_a_world.inverse() * camera.back_project(x, y, random.uniform(1.0, 4.0)));
    }
  }
  Eigen::Vector2d in_a(const Eigen::Vector3d& point) const { return camera.project(T_a_world * point); }
  Eigen::Vector2d in_b(const Eigen::Vector3d& point) const { return camera.project(T_b_world * point); }
};

TEST(Triangulation, BothMethodsGiveThePointBack) {
  const TwoViews views(1);
  for (const Eigen::Vector3d& point : views.points) {
    const Eigen::Vector2d a = views.in_a(point), b = views.in_b(point);
    const Eigen::Vector3d ray_a = views.camera.back_project(a.x(), a.y(), 1.0);
    const Eigen::Vector3d ray_b = views.camera.back_project(b.x(), b.y(), 1.0);
    const auto linear = triangulate_linear(views.T_a_world, ray_a, views.T_b_world, ray_b);
    ASSERT_TRUE(linear);
    EXPECT_LT((*linear - point).norm(), 1e-9);
    const Eigen::Isometry3d T_world_a = views.T_a_world.inverse(), T_world_b = views.T_b_world.inverse();
    const auto middle = triangulate_midpoint(T_world_a.translation(), T_world_a.linear() * ray_a,
                                             T_world_b.translation(), T_world_b.linear() * ray_b);
    ASSERT_TRUE(middle);
    EXPECT_LT((*middle - point).norm(), 1e-9);
    const TriangulatedPoint checked =
        triangulate(views.camera, PointView{views.T_a_world, a, 1.0}, PointView{views.T_b_world, b, 1.0});
    EXPECT_EQ(checked.status, TriangulationStatus::good);
    EXPECT_LT((checked.point - point).norm(), 1e-9);
  }
}

TEST(Triangulation, MidpointLiesHalfwayBetweenSkewRays) {
  const auto point = triangulate_midpoint({0, 0, 0}, {0, 0, 2}, {1, 0.2, 3}, {-5, 0, 0});
  ASSERT_TRUE(point);
  EXPECT_LT((*point - Eigen::Vector3d(0, 0.1, 3)).norm(), 1e-12);
  EXPECT_FALSE(triangulate_midpoint({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 3}));
}

TEST(Triangulation, SaysWhyAPointIsRefused) {
  const TwoViews views(2);
  const Eigen::Vector3d point = views.points[0];
  const Eigen::Vector2d a = views.in_a(point), b = views.in_b(point);
  const auto status = [&](const Eigen::Isometry3d& T_b_world, const Eigen::Vector2d& pixel_b) {
    return triangulate(views.camera, PointView{views.T_a_world, a, 1.0}, PointView{T_b_world, pixel_b, 1.0}).status;
  };
  EXPECT_EQ(status(views.T_a_world, a), TriangulationStatus::little_parallax);
  EXPECT_EQ(status(views.T_b_world, b + Eigen::Vector2d(0, 20)), TriangulationStatus::large_error);
  // Rays that part: mirrored disparity.
  EXPECT_EQ(status(views.T_b_world, b + Eigen::Vector2d(300, 0)), TriangulationStatus::behind_camera);
}

TEST(Epipolar, PixelsOfOnePointFulfilTheConstraint) {
  const TwoViews views(3);
  const Eigen::Matrix3d fundamental = fundamental_matrix(views.camera, views.T_a_world, views.T_b_world);
  const Eigen::Matrix3d essential = essential_matrix(views.T_a_world, views.T_b_world);
  for (const Eigen::Vector3d& point : views.points) {
    const Eigen::Vector2d a = views.in_a(point), b = views.in_b(point);
    EXPECT_LT(epipolar_line(fundamental, a).distance2(b.x(), b.y()), 1e-16);
    EXPECT_LT(std::abs((views.T_b_world * point).dot(essential * (views.T_a_world * point))), 1e-12);
  }
}

TEST(Epipolar, DistanceIsInPixels) {
  Camera camera = synthetic::camera();
  Eigen::Isometry3d T_b_world = Eigen::Isometry3d::Identity();
  T_b_world.translation().x() = -0.1;  // a sideways step: lines are rows
  const Eigen::Matrix3d fundamental = fundamental_matrix(camera, Eigen::Isometry3d::Identity(), T_b_world);
  const EpipolarLine line = epipolar_line(fundamental, {100, 50});
  EXPECT_NEAR(line.distance2(80, 53), 9.0, 1e-9);
  EXPECT_TRUE(line.is_near(80, 51.9, 1.0));  // chi-square at 95 %: 1.960 px
  EXPECT_FALSE(line.is_near(80, 52.1, 1.0));
  EXPECT_TRUE(line.is_near(80, 53.8, 0.25));
  EXPECT_FALSE(line.is_near(80, 54.0, 0.25));
  // Without a step there is no line, and nothing is near it.
  const Eigen::Matrix3d none = fundamental_matrix(camera, T_b_world, T_b_world);
  EXPECT_EQ(epipolar_line(none, {100, 50}).distance2(100, 50), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(epipolar_line(none, {100, 50}).is_near(100, 50, 1.0));
}

}  // namespace
}  // namespace holdfast::geometry
