// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/alignment.hpp"

#include <gtest/gtest.h>

#include "geometry/synthetic.hpp"

namespace holdfast::geometry {
namespace {

struct Clouds {
  std::vector<Eigen::Vector3d> source, target;
  Similarity truth;

  Clouds(int count, double scale, double noise, std::uint64_t seed) {
    Random random(seed);
    const Eigen::Isometry3d motion = exp_se3(synthetic::tangent(random, 1.0, 1.0));
    truth = {scale, motion.linear(), motion.translation()};
    for (int i = 0; i < count; ++i) {
      source.push_back({random.normal(), random.normal(), random.normal()});
      target.push_back(truth * source.back() +
                       noise * Eigen::Vector3d{random.normal(), random.normal(), random.normal()});
    }
  }
  double error(const Similarity& found) const {
    return std::abs(found.scale - truth.scale) + (found.rotation - truth.rotation).norm() +
           (found.translation - truth.translation).norm();
  }
};

TEST(Alignment, GivesTheSimilarityBack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Clouds clouds(10, 1.7, 0.0, seed);
    const auto found = align_points(clouds.source, clouds.target, true);
    ASSERT_TRUE(found);
    EXPECT_LT(clouds.error(*found), 1e-12);
    EXPECT_NEAR(found->rotation.determinant(), 1.0, 1e-12);
  }
  const Clouds rigid(10, 1.0, 0.0, 1);
  EXPECT_LT(rigid.error(*align_points(rigid.source, rigid.target)), 1e-12);
}

TEST(Alignment, NeverMirrorsFlatOrMirroredPoints) {
  Clouds clouds(20, 1.0, 0.0, 2);
  for (Eigen::Vector3d& point : clouds.source) point.z() = 0.0;
  for (std::size_t i = 0; i < clouds.source.size(); ++i) clouds.target[i] = clouds.truth * clouds.source[i];
  const auto flat = align_points(clouds.source, clouds.target);
  ASSERT_TRUE(flat);
  EXPECT_LT(clouds.error(*flat), 1e-12);
  Clouds mirrored(20, 1.0, 0.0, 3);
  for (Eigen::Vector3d& point : mirrored.target) point.x() = -point.x();
  EXPECT_NEAR(align_points(mirrored.source, mirrored.target)->rotation.determinant(), 1.0, 1e-12);
}

TEST(Alignment, RefusesWhatDoesNotDetermineAMotion) {
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  EXPECT_FALSE(align_points(line, line));
  EXPECT_FALSE(align_points(std::span(line).first(2), std::span(line).first(2)));
}

TEST(Alignment, RansacFindsTheMajority) {
  Clouds clouds(100, 1.3, 0.01, 4);
  Random random(5);
  for (int i = 0; i < 40; ++i) clouds.target[i] += Eigen::Vector3d{random.uniform(0.5, 3), random.uniform(-3, 3), 0.0};
  AlignmentRansacOptions options;
  options.with_scale = true;
  const auto found = align_points_ransac(clouds.source, clouds.target, options);
  ASSERT_TRUE(found);
  EXPECT_LT(clouds.error(found->similarity), 0.02);
  EXPECT_EQ(found->inliers, 60);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(found->inlier[i], i >= 40) << i;
  const auto again = align_points_ransac(clouds.source, clouds.target, options);
  EXPECT_EQ(found->similarity.translation, again->similarity.translation);
  options.minimum_inliers = 70;
  EXPECT_FALSE(align_points_ransac(clouds.source, clouds.target, options));
}

}  // namespace
}  // namespace holdfast::geometry
