// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/free_space.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <sstream>

#ifdef HOLDFAST_TEST_WITH_OCTOMAP
#include <octomap/OcTree.h>
#endif

#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A room of cameras that look down at a floor with a box on it: the world's z points down.
class FreeSpaceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
    world_.has_ball = false;
    world_.has_wall = world_.has_box = true;
    world_.box = Eigen::AlignedBox3d(Eigen::Vector3d(-0.3, -0.2, 2.1), Eigen::Vector3d(0.3, 0.2, 2.5));
    SurfaceSettings settings;
    settings.cell = 0.05;
    surface_.emplace(world_.camera, settings);
    std::vector<KeptView> views;
    std::vector<Eigen::Isometry3d> poses;
    for (const double x : {-0.9, -0.5, 0.0, 0.5, 0.9})
      for (const double y : {-0.7, 0.0, 0.7}) {
        poses.push_back(test::look_at({x, y, 0.3}, {0.5 * x, 0.5 * y, 2.5}));
        views.push_back(world_.view(poses.back(), views.size()));
      }
    surface_->update(views, poses, 0);
    mesh_ = surface_->field().mesh();
  }

  test::SolidWorld world_;
  std::optional<SurfaceMap> surface_;
  TriangleMesh mesh_;
};

TEST_F(FreeSpaceTest, KnowsFreeOccupiedAndUnknown) {
  const FreeSpace space(*surface_, mesh_, 0.05);
  EXPECT_TRUE(space.is_free({0.0, 0.0, 1.5}));
  EXPECT_TRUE(space.is_free({0.5, 0.4, 2.3}));
  EXPECT_EQ(space.at(Eigen::Vector3d(0.1, 0.05, 2.11)), Occupancy::occupied);  // the top of the box
  EXPECT_EQ(space.at(Eigen::Vector3d(0.0, 0.0, 2.3)), Occupancy::unknown);     // inside
  EXPECT_EQ(space.at(Eigen::Vector3d(0.0, 0.0, 3.0)), Occupancy::unknown);     // below the floor
  EXPECT_EQ(space.at(Eigen::Vector3d(100.0, 0.0, 0.0)), Occupancy::unknown);
}

TEST_F(FreeSpaceTest, GivesTheDistanceToTheNearestSurface) {
  const FreeSpace space(*surface_, mesh_, 0.05);
  EXPECT_NEAR(space.distance({0.0, 0.0, 1.5}), 0.6, 0.06);
  EXPECT_NEAR(space.distance({0.7, 0.6, 2.3}), 0.2, 0.06);
  EXPECT_EQ(space.distance({0.1, 0.05, 2.11}), 0.0);
  EXPECT_GE(space.distance({100.0, 0.0, 0.0}), 90.0);
}

TEST_F(FreeSpaceTest, TransformsDistancesAsBruteForceDoes) {
  const FreeSpace space(*surface_, mesh_, 0.1);
  std::vector<Eigen::Vector3i> occupied;
  const Eigen::Vector3i size = space.size();
  const auto visit = [&](const auto& each) {
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x) each(Eigen::Vector3i(x, y, z));
  };
  visit([&](const Eigen::Vector3i& cell) {
    if (space.at(cell) == Occupancy::occupied) occupied.push_back(cell);
  });
  ASSERT_GT(occupied.size(), 100U);
  int compared = 0;
  visit([&](const Eigen::Vector3i& cell) {
    if ((cell.x() + 3 * cell.y() + 7 * cell.z()) % 11 != 0) return;
    int nearest = 1 << 30;
    for (const Eigen::Vector3i& other : occupied) nearest = std::min(nearest, (cell - other).squaredNorm());
    EXPECT_NEAR(space.distance(space.centre_of(cell)), 0.1 * std::sqrt(nearest), 1e-5);
    ++compared;
  });
  EXPECT_GT(compared, 200);
}

TEST_F(FreeSpaceTest, FindsTheFloorBelowTheBox) {
  const std::optional<Floor> floor = find_floor(mesh_, Eigen::Vector3d(0.9, -0.1, -1.0));
  ASSERT_TRUE(floor);
  EXPECT_GT(floor->up.dot(-Eigen::Vector3d::UnitZ()), 0.9999);
  EXPECT_NEAR(floor->height, -2.5, 0.005);
  EXPECT_GT(floor->area, 3.0);
  const std::optional<Floor> ceiling = find_floor(mesh_, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(!ceiling || ceiling->area < 0.1);
}

TEST_F(FreeSpaceTest, MakesAMapOfTheFloor) {
  const NavigationMaps maps = make_navigation_maps(*surface_, mesh_);
  // The cameras look along the world's z, which is down: their up is no guess for it here.
  const std::optional<Floor> floor = find_floor(mesh_, -Eigen::Vector3d::UnitZ());
  const FreeSpace space(*surface_, mesh_, 0.05);
  const auto state = [&](const SurfaceSettings& settings, double x, double y) {
    const GridMap map = make_grid_map(space, mesh_, *floor, settings);
    const Eigen::Vector3d p = map.T_map_world * Eigen::Vector3d(x, y, 2.5);
    EXPECT_NEAR(p.z(), 0.0, 0.01);
    const Eigen::Vector2d cell = (p.head<2>() - map.origin) / map.resolution;
    return map.at(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
  };
  EXPECT_EQ(state({}, 0.0, 0.0), Occupancy::occupied);
  EXPECT_EQ(state({}, 0.8, 0.6), Occupancy::free);
  // A board above a floor that was seen.
  const TriangleMesh without = mesh_;
  const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
  for (const Eigen::Vector3f& corner :
       {Eigen::Vector3f(0.7F, 0.5F, 2.0F), Eigen::Vector3f(0.9F, 0.5F, 2.0F), Eigen::Vector3f(0.8F, 0.8F, 2.0F)})
    mesh_.vertices.push_back({corner, {}, 0, 0, 0});
  mesh_.triangles.push_back({first, first + 1, first + 2});
  EXPECT_EQ(state({}, 0.8, 0.6), Occupancy::occupied);
  EXPECT_EQ(state({.robot_highest = 0.4}, 0.8, 0.6), Occupancy::free) << "low enough to drive under the board";
  mesh_ = without;
  EXPECT_EQ(state({.robot_lowest = 0.45}, 0.0, 0.0), Occupancy::free) << "high enough to drive over the box";
  EXPECT_FALSE(maps.octomap.empty());
}

#ifdef HOLDFAST_TEST_WITH_OCTOMAP
TEST_F(FreeSpaceTest, OctoMapsLibraryFindsEveryCellAsItIs) {
  const FreeSpace space(*surface_, mesh_, 0.05);
  std::istringstream states(space.octomap()), probabilities(space.octomap_probabilities());
  octomap::OcTree binary(0.05);
  ASSERT_TRUE(binary.readBinary(states));
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(probabilities));
  const auto* full = dynamic_cast<octomap::OcTree*>(read.get());
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(full->getResolution(), 0.05);
  EXPECT_GT(full->size(), binary.size());
  int certain = 0, free = 0, occupied = 0;
  const Eigen::Vector3i size = space.size();
  for (int z = 0; z < size.z(); ++z)
    for (int y = 0; y < size.y(); ++y)
      for (int x = 0; x < size.x(); ++x) {
        const Eigen::Vector3d p = space.centre_of({x, y, z});
        const int evidence = space.evidence({x, y, z});
        const octomap::OcTreeNode* state = binary.search(p.x(), p.y(), p.z());
        const octomap::OcTreeNode* node = full->search(p.x(), p.y(), p.z());
        ASSERT_EQ(node != nullptr, evidence != 0) << p.transpose();
        ASSERT_EQ(state != nullptr, evidence != 0) << p.transpose();
        if (node == nullptr) continue;
        ASSERT_EQ(node->getLogOdds(), FreeSpace::log_odds(evidence)) << p.transpose();
        ASSERT_EQ(full->isNodeOccupied(node), evidence > 0);
        ASSERT_EQ(binary.isNodeOccupied(state), evidence > 0);
        certain += std::abs(evidence) >= 3, free += evidence<0, occupied += evidence> 0;
      }
  EXPECT_GT(free, 1000);
  EXPECT_GT(occupied, 200);
  EXPECT_GT(certain, 500);
  EXPECT_LT(certain, free + occupied) << "at the rims few views look";
}
#endif

TEST_F(FreeSpaceTest, WritesFilesOfTheMapServerAndOctoMap) {
  const FreeSpace space(*surface_, mesh_, 0.05);
  EXPECT_THAT(space.octomap(), StartsWith("# Octomap OcTree binary file\n"));
  EXPECT_THAT(space.octomap_probabilities(), StartsWith("# Octomap OcTree file\n"));
  EXPECT_THAT(space.octomap(), HasSubstr("id OcTree\nsize "));
  EXPECT_THAT(space.octomap(), HasSubstr("\nres 0.05\ndata\n"));
  GridMap map;
  map.width = 2, map.height = 2;
  map.origin = {-1.5, 2.25};
  map.cells = {Occupancy::occupied, Occupancy::free, Occupancy::unknown, Occupancy::free};
  EXPECT_EQ(grid_map_pgm(map), std::string("P5\n2 2\n255\n\xCD\xFE\x00\xFE", 15));
  EXPECT_THAT(grid_map_yaml(map, "map.pgm"),
              StartsWith("image: map.pgm\nresolution: 0.05\norigin: [-1.500000, 2.250000, 0.0]\nnegate: 0\n"));
}

}  // namespace
}  // namespace holdfast
