// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "holdfast/surface/mesh_patches.hpp"
#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

using test::SolidWorld;

using Cube = std::tuple<int, int, int>;
using Patches = std::map<Cube, SurfacePatch>;

/// Takes over changes as an observer does it.
void apply(std::vector<SurfacePatch> changes, Patches& patches) {
  for (SurfacePatch& patch : changes) {
    const Cube cube{patch.cube.x(), patch.cube.y(), patch.cube.z()};
    patches.erase(cube);
    if (!patch.triangles.empty()) patches.emplace(cube, std::move(patch));
  }
}

double area_of(const Patches& patches) {
  double area = 0.0;
  for (const auto& [cube, patch] : patches)
    for (const auto& t : patch.triangles) {
      const Eigen::Vector3f a = patch.vertices[t[0]].position;
      area += 0.5 *
              static_cast<double>((patch.vertices[t[1]].position - a).cross(patch.vertices[t[2]].position - a).norm());
    }
  return area;
}

/// Positions of the corners of all triangles, sorted.
std::vector<std::tuple<float, float, float>> corners_of(const Patches& patches) {
  std::vector<std::tuple<float, float, float>> corners;
  for (const auto& [cube, patch] : patches)
    for (const auto& triangle : patch.triangles)
      for (const std::uint16_t corner : triangle) {
        const Eigen::Vector3f& p = patch.vertices[corner].position;
        corners.emplace_back(p.x(), p.y(), p.z());
      }
  std::sort(corners.begin(), corners.end());
  return corners;
}

class SurfacePatchesTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
    for (const Eigen::Isometry3d& pose : poses_) views_.push_back(world_.view(pose, views_.size()));
    settings_.smallest_part = 0.0;
  }
  void fuse(SurfaceMap& map, std::size_t count) const {
    const auto end = static_cast<std::ptrdiff_t>(count);
    map.update({views_.begin(), views_.begin() + end}, {poses_.begin(), poses_.begin() + end}, 0);
  }

  SolidWorld world_;
  SurfaceSettings settings_;
  std::vector<Eigen::Isometry3d> poses_ = test::poses_around(world_.centre, 1.2);
  std::vector<KeptView> views_;
};

TEST_F(SurfacePatchesTest, TogetherAreTheMesh) {
  SurfaceMap map(world_.camera, settings_);
  fuse(map, views_.size());
  Patches patches;
  apply(map.field().changes(0, 0), patches);
  const TriangleMesh mesh = map.field().mesh();
  std::vector<std::tuple<float, float, float>> corners;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.corner(i, k);
      corners.emplace_back(p.x(), p.y(), p.z());
    }
  std::sort(corners.begin(), corners.end());
  EXPECT_EQ(corners_of(patches), corners);
  for (const auto& [cube, patch] : patches)
    for (const MeshVertex& vertex : patch.vertices) {
      const Eigen::Vector3d outwards = (vertex.position.cast<double>() - world_.centre).normalized();
      EXPECT_GT(outwards.dot(vertex.normal.cast<double>()), 0.8);
      EXPECT_EQ(vertex.red, 200);
    }
}

TEST_F(SurfacePatchesTest, OfChangesBringAnObserverUpToDate) {
  SurfaceMap map(world_.camera, settings_);
  Patches followed;
  std::uint64_t seen = 0;
  for (const std::size_t count : {10U, 11U, 12U, 40U, 20U}) {  // the last one takes views out
    fuse(map, count);
    apply(map.field().changes(seen, 0), followed);
    seen = map.field().version();
    Patches whole;
    apply(map.field().changes(0, 0), whole);
    EXPECT_EQ(corners_of(followed), corners_of(whole)) << count << " views";
    EXPECT_TRUE(map.field().changes(seen, 0).empty());
  }
  fuse(map, 0);
  apply(map.field().changes(seen, 0), followed);
  EXPECT_TRUE(followed.empty());
}

TEST_F(SurfacePatchesTest, ChangesAreWhereTheViewLooks) {
  SolidWorld wall;
  wall.has_ball = false, wall.has_wall = true;
  SurfaceMap map(wall.camera, settings_);
  std::vector<KeptView> views;
  std::vector<Eigen::Isometry3d> poses;
  const auto add = [&](double x) {
    poses.push_back(Eigen::Isometry3d::Identity());
    poses.back().translation().x() = x;
    views.push_back(wall.view(poses.back(), views.size()));
    map.update(views, poses, 0);
  };
  add(0.0), add(0.0), add(10.0), add(10.0);
  const std::uint64_t before = map.field().version();
  add(10.0);
  const std::size_t all = map.field().changes(0, 0).size();
  const std::vector<SurfacePatch> changes = map.field().changes(before, 0);
  EXPECT_GT(changes.size(), all / 4);
  for (const SurfacePatch& patch : changes) EXPECT_GT(patch.cube.x() * 8 * settings_.voxel, 5.0);
}

TEST_F(SurfacePatchesTest, OfCoarserSamplesAreTheSameSurfaceInFewerTriangles) {
  SurfaceMap map(world_.camera, settings_);
  fuse(map, views_.size());
  const double area = 4.0 * M_PI * SolidWorld::radius * SolidWorld::radius;
  std::size_t before = 0;
  for (const int coarseness : {0, 1, 2}) {
    Patches patches;
    apply(map.field().changes(0, coarseness), patches);
    std::size_t triangles = 0;
    double worst = 0.0;
    for (const auto& [cube, patch] : patches) {
      triangles += patch.triangles.size();
      for (const MeshVertex& vertex : patch.vertices)
        worst = std::max(worst, std::abs((vertex.position.cast<double>() - world_.centre).norm() - SolidWorld::radius));
    }
    EXPECT_LT(worst, 0.015 * (1 << coarseness));
    if (coarseness < 2) {
      EXPECT_NEAR(area_of(patches), area, 0.03 * area) << coarseness;
    }
    if (coarseness > 0) {
      EXPECT_LT(3 * triangles, before);
    }
    before = triangles;
  }
}

TEST_F(SurfacePatchesTest, OfAMeshHaveItsTriangles) {
  SurfaceMap map(world_.camera, settings_);
  fuse(map, views_.size());
  const TriangleMesh mesh = map.field().mesh();
  TriangleMesh large;  // more triangles in one cube than a patch can have
  for (int copy = 0; copy < 3; ++copy) {
    const auto first = static_cast<std::uint32_t>(large.vertices.size());
    for (MeshVertex vertex : mesh.vertices) {
      vertex.position *= 0.3F;
      large.vertices.push_back(vertex);
    }
    for (const auto& t : mesh.triangles) large.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  std::size_t triangles = 0;
  double area = 0.0;
  for (SurfacePatch& patch : patches_of(large)) {
    triangles += patch.triangles.size();
    EXPECT_LE(patch.triangles.size(), 10'000U);
    area += area_of({{Cube{}, std::move(patch)}});
  }
  EXPECT_EQ(triangles, large.triangles.size());
  EXPECT_NEAR(area, large.area(), 1e-3 * large.area());
}

}  // namespace
}  // namespace holdfast
