// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/two_view_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/synthetic.hpp"

namespace holdfast::geometry {
namespace {

struct Scene {
  Camera camera = synthetic::camera();
  Eigen::Isometry3d T_b_a;
  std::vector<Eigen::Vector3d> points;  // in camera a
  std::vector<PixelPair> pairs;

  /// `plane`: all points on a slanting wall. A share of `outliers` is matched with a pixel anywhere.
  Scene(const Vector6d& motion, bool plane, double noise, double outliers, std::uint64_t seed)
      : T_b_a(exp_se3(motion)) {
    Random random(seed);
    while (pairs.size() < 300) {
      const double x = random.uniform(20, 620), y = random.uniform(20, 460);
      const double depth = plane ? 2.0 / (1.0 + 0.4 * (x - 320) / 500 - 0.2 * (y - 240) / 500) : random.uniform(1, 5);
      const Eigen::Vector3d point = camera.back_project(x, y, depth);
      const Eigen::Vector2d a = camera.project(point), b = camera.project(T_b_a * point);
      const auto noisy = [&](const Eigen::Vector2d& pixel) -> Eigen::Vector2d {
        return pixel + noise * Eigen::Vector2d{random.normal(), random.normal()};
      };
      PixelPair pair{noisy(a), noisy(b), 1.0, 1.0};
      if (random.uniform() < outliers) pair.b = {random.uniform(0, 640), random.uniform(0, 480)};
      points.push_back(point);
      pairs.push_back(pair);
    }
  }

  void expect_found(const std::optional<TwoViewMotion>& found, double max_angle) const {
    ASSERT_TRUE(found);
    const double turn = log_so3(Eigen::Matrix3d(found->T_b_a.linear() * T_b_a.linear().transpose())).norm();
    EXPECT_LT(turn, max_angle);
    EXPECT_NEAR(found->T_b_a.translation().norm(), 1.0, 1e-9);
    EXPECT_LT(std::acos(std::min(1.0, found->T_b_a.translation().dot(T_b_a.translation().normalized()))),
              10 * max_angle);
    const double scale = T_b_a.translation().norm();
    int wrong = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (found->good[i] != 0)
        wrong += (scale * found->points[i] - points[i]).norm() > 40 * max_angle * points[i].norm() ? 1 : 0;
    EXPECT_LT(wrong, 0.1 * found->good_points);
    EXPECT_GE(found->good_points, 150);
  }
};

Vector6d motion(double x, double y, double z, double turn) {
  Vector6d result;
  result << x, y, z, 0.3 * turn, turn, -0.5 * turn;
  return result;
}

TEST(TwoViewMotion, FindsTheMotionInASceneOfAnyShape) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Scene scene(motion(0.3, -0.05, 0.1, 0.05), false, 0.0, 0.0, seed);
    const auto found = find_two_view_motion(scene.camera, scene.pairs);
    scene.expect_found(found, 1e-5);
    EXPECT_FALSE(found->is_planar);
    EXPECT_EQ(found->good_points, 300);
  }
}

TEST(TwoViewMotion, FindsTheMotionBeforeAWall) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Scene scene(motion(-0.25, 0.1, 0.15, -0.04), true, 0.0, 0.0, seed);
    const auto found = find_two_view_motion(scene.camera, scene.pairs, {.rival_share = 0.9999});
    scene.expect_found(found, 1e-5);
    EXPECT_TRUE(found->is_planar);
  }
}

TEST(TwoViewMotion, FindsTheMotionStraightTowardsAWall) {
  Scene scene(motion(0, 0, -0.4, 0), false, 0.0, 0.0, 1);
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const Eigen::Vector2d pixel = scene.pairs[i].a;
    scene.points[i] = scene.camera.back_project(pixel.x(), pixel.y(), 2.0);
    scene.pairs[i].b = scene.camera.project(scene.T_b_a * scene.points[i]);
  }
  const auto found = find_two_view_motion(scene.camera, scene.pairs);
  scene.expect_found(found, 1e-5);
}

TEST(TwoViewMotion, ToleratesNoiseAndWrongMatches) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Scene scene(motion(0.3, 0.05, 0.05, 0.05), false, 0.5, 0.15, seed);
    scene.expect_found(find_two_view_motion(scene.camera, scene.pairs), 0.01);
  }
}

TEST(TwoViewMotion, RefusesWhatDeterminesNoMotion) {
  const Scene rotation(motion(0, 0, 0, 0.1), false, 0.3, 0.0, 1), still(motion(0.002, 0, 0, 0), false, 0.3, 0.0, 1);
  EXPECT_FALSE(find_two_view_motion(rotation.camera, rotation.pairs));
  EXPECT_FALSE(find_two_view_motion(still.camera, still.pairs));
  const Scene scene(motion(0.3, 0, 0, 0.05), false, 0.0, 0.0, 1);
  EXPECT_FALSE(find_two_view_motion(scene.camera, std::span(scene.pairs).first(30)));
  std::vector<PixelPair> same(100, scene.pairs[0]), broken(100, {{NAN, NAN}, {NAN, NAN}, 1, 1});
  EXPECT_FALSE(find_two_view_motion(scene.camera, same));
  EXPECT_FALSE(find_two_view_motion(scene.camera, broken));
}

TEST(TwoViewMotion, IsTheSameForTheSameSeed) {
  const Scene scene(motion(0.3, 0.05, 0.05, 0.05), false, 0.5, 0.1, 4);
  const auto a = find_two_view_motion(scene.camera, scene.pairs), b = find_two_view_motion(scene.camera, scene.pairs);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->T_b_a.matrix(), b->T_b_a.matrix());
  EXPECT_EQ(a->points, b->points);
}

TEST(EightPoint, HomographyMapsPixels) {
  const Scene scene(motion(-0.25, 0.1, 0.15, -0.04), true, 0.0, 0.0, 5);
  std::vector<Eigen::Vector2d> a, b;
  for (const PixelPair& pair : scene.pairs) a.push_back(pair.a), b.push_back(pair.b);
  const auto homography = estimate_homography(std::span(a).first(4), std::span(b).first(4));
  ASSERT_TRUE(homography);
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_LT(((*homography * a[i].homogeneous()).hnormalized() - b[i]).norm(), 1e-6);
}

}  // namespace
}  // namespace holdfast::geometry
