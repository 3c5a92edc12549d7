// SPDX-License-Identifier: BSD-3-Clause
#include "depth_clusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "filters/judged_frames.hpp"

namespace holdfast::depth_clusters_plugin {
namespace {

using depth_blocks::ViewMaker;
using test::JudgedFrames;
using test::Surface;

ParameterValues scene(const std::string& name, std::vector<std::string> set) {
  return {{"scene", std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/" + name + ".yaml"}, {"set", std::move(set)}};
}

ParameterValues walkers() {
  std::vector<std::string> set{"duration=1"};
  for (const char* person : {"0", "1", "2", "3"}) set.push_back(std::string("people.") + person + ".start=-8");
  return scene("walking_xyz", set);
}

Eigen::Isometry3d no_error(std::uint64_t) { return Eigen::Isometry3d::Identity(); }

/// Features, by surface, of the frames that were judged: how many, and how many of them were called moving and static.
struct Counts {
  std::array<int, 3> all{}, moving{}, standing{};
  int evaluated_frames = 0;
  std::vector<float> said;

  double share(const std::array<int, 3>& of, Surface surface) const {
    const auto i = static_cast<std::size_t>(surface);
    return of[i] / std::max(1.0, static_cast<double>(all[i]));
  }
};

Counts count(const ParameterValues& values, const JudgedFrames::PoseError& error = no_error) {
  JudgedFrames frames("simulated", values);
  DepthClusters filter({}, frames.context());
  Counts counts;
  frames.run_with_poses(filter, error,
                        [&](const SensorFrame& image, const Frame& frame, const StaticEvidence& evidence) {
                          if (!filter.evaluated()) {
                            EXPECT_TRUE(evidence.contributions().empty());
                            return;
                          }
                          ++counts.evaluated_frames;
                          for (std::size_t i = 0; i < frame.size(); ++i) {
                            const auto surface = static_cast<std::size_t>(test::surface_of(image, frame, i));
                            const float said = evidence.measurement(i);
                            ++counts.all[surface];
                            counts.moving[surface] += said <= -1.0F ? 1 : 0;
                            counts.standing[surface] += said > 0.0F ? 1 : 0;
                            counts.said.push_back(said);
                          }
                        });
  return counts;
}

TEST(DepthClusters, TellsPeopleWhoWalkFromTheRoom) {
  const Counts counts = count(walkers());
  EXPECT_GE(counts.evaluated_frames, 15);
  // Half of them stand, and plain clothes that slide along themselves show only at their edges.
  EXPECT_GE(counts.share(counts.moving, Surface::moving), 0.3);
  EXPECT_LE(counts.share(counts.moving, Surface::still), 0.03);
  EXPECT_GE(counts.share(counts.standing, Surface::still), 0.6);
}

TEST(DepthClusters, RaisesNoAlarmWhereNothingMoves) {
  const Counts counts = count(scene("empty", {"duration=1", "camera.speed=2"}));
  EXPECT_GE(counts.evaluated_frames, 15);
  EXPECT_LE(counts.share(counts.moving, Surface::still), 0.03);
}

TEST(DepthClusters, AnErrorOfThePredictedPoseIsNotAMovement) {
  const Counts counts = count(scene("empty", {"duration=1"}), [](std::uint64_t index) {
    Eigen::Isometry3d error(Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, -1, 1).normalized()));
    error.translation() = (index % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d(0.015, -0.01, 0.015);
    return error;
  });
  EXPECT_GE(counts.evaluated_frames, 10);
  EXPECT_LE(counts.share(counts.moving, Surface::still), 0.05);
}

TEST(DepthClusters, AHopelessPoseIsNotAMovementOfTheWorld) {
  const Counts counts = count(scene("empty", {"duration=0.7"}), [](std::uint64_t index) {
    Eigen::Isometry3d error = Eigen::Isometry3d::Identity();
    if (index > 10) error.translation() = Eigen::Vector3d(0.5, 0.1, -0.6);
    return error;
  });
  EXPECT_LE(counts.share(counts.moving, Surface::still), 0.05);
}

TEST(DepthClusters, AChairThatFillsTheViewIsNotTheWorld) {
  const Counts counts = count(scene("rolling_chair", {"duration=1.3"}));
  EXPECT_GE(counts.evaluated_frames, 20);
  EXPECT_GE(counts.share(counts.moving, Surface::moving), 0.6);
  EXPECT_LE(counts.share(counts.moving, Surface::still), 0.1);
}

TEST(DepthClusters, SameFramesSameEvidence) {
  const ParameterValues values = scene("walking_xyz", {"duration=0.3", "people.0.start=-8"});
  const Counts first = count(values), second = count(values);
  EXPECT_GT(first.said.size(), 500U);
  EXPECT_EQ(first.said, second.said);
}

/// A view of a wall, and of a box before it in the middle.
DepthView box_before_wall(const BlockGrid& grid) {
  DepthView view;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const bool box = std::abs(column - grid.columns / 2) < 12 && std::abs(row - grid.rows / 2) < 10;
      view.depth.push_back(row == 0 ? 0.0F : box ? 1.5F : 3.0F);
    }
  view.grey.assign(view.depth.size(), 100.0F);
  return view;
}

TEST(KMeans, ClustersDoNotReachOverAStepOfDepth) {
  const ViewMaker maker(*find_camera("tum_fr3"));
  const DepthView view = box_before_wall(maker.grid());
  KMeans clusters(24, 6);
  clusters.divide(maker.grid(), view);
  ASSERT_EQ(clusters.count(), 24);
  std::vector<int> on_box(24, 0), on_wall(24, 0);
  for (std::size_t i = 0; i < view.depth.size(); ++i) {
    const std::uint8_t cluster = clusters.cluster_of()[i];
    EXPECT_EQ(cluster == KMeans::none, view.depth[i] == 0.0F);
    if (cluster != KMeans::none) ++(view.depth[i] == 1.5F ? on_box : on_wall)[cluster];
  }
  for (int k = 0; k < 24; ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    EXPECT_TRUE(on_box[i] == 0 || on_wall[i] == 0) << "cluster " << k;
    EXPECT_EQ(on_box[i] + on_wall[i], clusters.sizes()[i]);
  }
}

TEST(SurfaceAt, InterpolatesOnSurfacesAndNotOverEdges) {
  const ViewMaker maker(*find_camera("tum_fr3"));
  const BlockGrid& grid = maker.grid();
  DepthView view = box_before_wall(grid);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < 10; ++column)
      view.depth[static_cast<std::size_t>(row * grid.columns + column)] = 2.0F + 0.01F * column + 0.02F * row;
  const auto slope = surface_at(grid, view, 4.25F, 8.5F);
  ASSERT_TRUE(slope.known && slope.smooth);
  EXPECT_NEAR(slope.depth, 2.2125F, 1e-5F);
  EXPECT_NEAR(slope.depth_x, 0.01F, 1e-5F);
  EXPECT_NEAR(slope.depth_y, 0.02F, 1e-5F);
  const auto edge =
      surface_at(grid, view, static_cast<float>(grid.columns / 2 - 12) + 0.4F, static_cast<float>(grid.rows / 2));
  ASSERT_TRUE(edge.known);
  EXPECT_FALSE(edge.smooth);
  EXPECT_EQ(edge.nearest, 1.5F);
  EXPECT_EQ(edge.farthest, 3.0F);
  EXPECT_FALSE(surface_at(grid, view, 20.0F, 0.5F).known);
  EXPECT_FALSE(surface_at(grid, view, -0.5F, 5.0F).known);
}

}  // namespace
}  // namespace holdfast::depth_clusters_plugin
