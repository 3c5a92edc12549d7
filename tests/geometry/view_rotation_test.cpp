// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/view_rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/synthetic.hpp"

namespace holdfast::geometry {
namespace {

struct Rays {
  std::vector<Eigen::Vector3d> a, b;

  /// Points at 1 to 3 m before a camera that turns and moves by 4 mm; a share of the matches is wrong.
  Rays(int count, const Eigen::Vector3d& rotation, double wrong, std::uint64_t seed) {
    const Camera camera = synthetic::camera();
    Random random(seed);
    const auto point = [&] {
      return camera.back_project(random.uniform(20, 620), random.uniform(20, 460), random.uniform(1, 3));
    };
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d in_a = point();
      a.push_back(in_a.normalized());
      b.push_back((random.uniform(0, 1) < wrong ? point() : exp_so3(rotation) * in_a + Eigen::Vector3d(0.004, 0, 0))
                      .normalized());
    }
  }
};

TEST(ViewRotation, IsFoundAmongWrongMatches) {
  const Eigen::Vector3d rotation(0.02, -0.05, 0.03);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Rays rays(300, rotation, 0.3, seed);
    const auto found = view_rotation(rays.a, rays.b);
    ASSERT_TRUE(found);
    // What is left is the parallax of the motion, 4 mm at about 2 m, which looks like a turn about the vertical axis.
    EXPECT_LT((*found - rotation).norm(), 0.004) << "seed " << seed;
    EXPECT_LT(std::abs(found->x() - rotation.x()), 5e-4) << "seed " << seed;
    EXPECT_LT(std::abs(found->z() - rotation.z()), 1e-3) << "seed " << seed;
  }
}

TEST(ViewRotation, NeedsTwentyPairsOfFiniteRays) {
  const Rays few(19, {0.0, 0.1, 0.0}, 0.0, 1), enough(20, {0.0, 0.1, 0.0}, 0.0, 1);
  EXPECT_FALSE(view_rotation(few.a, few.b));
  EXPECT_TRUE(view_rotation(enough.a, enough.b));
  Rays bad = enough;
  bad.b[3].x() = std::nan("");
  EXPECT_FALSE(view_rotation(bad.a, bad.b));
  const std::vector<Eigen::Vector3d> same(30, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(view_rotation(same, same)) << "one direction leaves the turn about itself open";
}

}  // namespace
}  // namespace holdfast::geometry
