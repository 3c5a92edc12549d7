// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/local_map.hpp"

#include <gtest/gtest.h>

#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "support/point_world.hpp"

namespace holdfast {
namespace {

/// A map of one keyframe at the identity in which every feature is a point, and the frame that made it.
struct OneKeyframe {
  OneKeyframe()
      : world(find_camera("tum_fr3").value()),
        extractor(world),
        depth(world.camera(), 0.0),
        builder(world.camera(), extractor, depth) {
    frame = build(Eigen::Isometry3d::Identity());
    id = map.add_keyframe(frame);
    for (std::uint32_t i = 0; i < frame.size(); ++i) {
      const MapPointId point = map.add_point(frame.camera_point(i), 0);
      map.add_observation(point, id, i);
      map.update_point(point);
    }
    frame.map_points = map.keyframe(id).frame.map_points;
  }
  Frame build(const Eigen::Isometry3d& T_world_camera) {
    Frame built;
    StageTimes times;
    builder.build(world.frame(0, 0.0, T_world_camera), built, times);
    built.T_camera_world = T_world_camera.inverse();
    return built;
  }
  test::PointWorld world;
  test::PointExtractor extractor;
  ImageDepth depth;
  FrameBuilder builder;
  Map map;
  KeyFrameId id;
  Frame frame;
};

TEST(LocalMap, ProjectsEveryPointOntoItsFeature) {
  OneKeyframe scene;
  LocalMap local_map(10);
  local_map.update(scene.map, scene.frame, 1);
  EXPECT_EQ(local_map.reference_keyframe(), scene.id);
  EXPECT_EQ(local_map.points().size(), scene.frame.size());
  Frame empty = scene.frame;
  std::fill(empty.map_points.begin(), empty.map_points.end(), MapPointId());
  matching::SearchWindows windows;
  local_map.project(empty, 1.0F, windows);
  EXPECT_EQ(windows.size(), scene.frame.size());
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const MapPointId point = local_map.points().ids[windows.source[w]];
    const auto feature = static_cast<std::size_t>(scene.map.feature_of(point, scene.id));
    EXPECT_NEAR(windows.x[w], scene.frame.x[feature], 0.01);
    EXPECT_NEAR(windows.y[w], scene.frame.y[feature], 0.01);
    EXPECT_NEAR(windows.right_x[w], scene.frame.right_x[feature], 0.01);
    EXPECT_GE(scene.frame.features.octave[feature], windows.min_octave[w]);
    EXPECT_LE(scene.frame.features.octave[feature], windows.max_octave[w]);
  }
}

TEST(LocalMap, LeavesOutWhatTheFrameShowsAlreadyAndWhatLiesBehind) {
  OneKeyframe scene;
  LocalMap local_map(10);
  local_map.update(scene.map, scene.frame, 1);
  matching::SearchWindows windows;
  local_map.project(scene.frame, 1.0F, windows);
  EXPECT_EQ(windows.size(), 0U);
  Frame turned = scene.frame;
  std::fill(turned.map_points.begin(), turned.map_points.end(), MapPointId());
  turned.T_camera_world = Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitY()) * turned.T_camera_world;
  local_map.project(turned, 1.0F, windows);
  EXPECT_EQ(windows.size(), 0U);
}

TEST(LocalMap, CountsReachTheMap) {
  OneKeyframe scene;
  LocalMap local_map(10);
  local_map.update(scene.map, scene.frame, 1);
  const MapPointId shown = scene.frame.map_points[0];
  Frame frame = scene.frame;
  std::fill(frame.map_points.begin() + 1, frame.map_points.end(), MapPointId());
  matching::SearchWindows windows;
  for (int i = 0; i < 5; ++i) local_map.project(frame, 1.0F, windows), local_map.count_found(frame);
  local_map.write_counts(scene.map);
  EXPECT_EQ(scene.map.point(shown).visible_count, 6U);
  EXPECT_EQ(scene.map.point(shown).found_count, 6U);
  const MapPointId missed = scene.frame.map_points[1];
  EXPECT_EQ(scene.map.point(missed).visible_count, 6U);
  EXPECT_EQ(scene.map.point(missed).found_count, 1U);
}

}  // namespace
}  // namespace holdfast
