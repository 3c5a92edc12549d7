// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/local_mapper.hpp"

#include <gtest/gtest.h>

#include "holdfast/plugin/registry.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

/// A mapper over a world of points. Frames come without matches: what the map knows of them, fusion has to find out.
class LocalMapperTest : public testing::Test {
 protected:
  LocalMapperTest()
      : world(find_camera("tum_fr3").value(), 800), extractor(world, 0.2), builder(world.camera(), extractor, 0.0) {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    optimizer = registry.create<Optimizer>("ceres", {}, {});
    mapper = std::make_unique<LocalMapper>(MappingSettings{}, map, mutex, *optimizer);
  }

  Frame frame_at(const Eigen::Isometry3d& T_world_camera) {
    Frame frame;
    builder.build(world.frame(index, static_cast<double>(index), T_world_camera), frame, times);
    ++index;
    frame.T_camera_world = T_world_camera.inverse();
    return frame;
  }
  /// Names the points of the map that the frame's features show, by descriptor, every `n`th only.
  void match(Frame& frame, std::size_t n) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < frame.size(); ++i)
      map.points().for_each([&](MapPointId id, const MapPoint& point) {
        if (hamming_distance(point.descriptor, frame.features.descriptors[i]) < 40 && found++ % n == 0)
          frame.map_points[i] = id;
      });
  }
  KeyFrameId add_keyframe(const Frame& frame) {
    const KeyFrameId keyframe = mapper->insert(frame, false, times);
    mapper->refine(keyframe, times);
    return keyframe;
  }
  static Eigen::Isometry3d beside(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); }

  test::PointWorld world;
  test::PointExtractor extractor;
  FrameBuilder builder;
  Map map;
  MapMutex mutex;
  std::unique_ptr<Optimizer> optimizer;
  std::unique_ptr<LocalMapper> mapper;
  StageTimes times;
  std::uint64_t index = 0;
};

TEST_F(LocalMapperTest, FirstKeyframeMakesItsClosePointsFromDepth) {
  const Frame frame = frame_at(beside(0));
  add_keyframe(frame);
  std::size_t close = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) close += frame.has_depth(i) && frame.depth[i] <= 3.2F ? 1 : 0;
  ASSERT_GT(close, 100U);
  EXPECT_EQ(map.points().size(), close);
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    const auto feature = point.observations.front().feature;
    EXPECT_LT((point.position - frame.camera_point(feature)).norm(), 1e-9);
  });
}

TEST_F(LocalMapperTest, PointsSeenTwiceBecomeOne) {
  add_keyframe(frame_at(beside(0)));
  const std::size_t first = map.points().size();
  Frame frame = frame_at(beside(0.05));
  match(frame, 3);  // a third is tracked, the others are made again from depth
  add_keyframe(frame);
  EXPECT_GT(mapper->counts().points_fused, first / 3);
  EXPECT_LT(map.points().size(), first * 12 / 10);
  std::size_t seen_twice = 0;
  map.points().for_each(
      [&](MapPointId, const MapPoint& point) { seen_twice += point.observations.size() == 2 ? 1 : 0; });
  EXPECT_GT(seen_twice, first * 8 / 10);
}

TEST_F(LocalMapperTest, FeaturesWithoutDepthAreTriangulated) {
  const auto without_far_depth = [](Frame frame) {
    for (std::size_t i = 0; i < frame.size(); ++i)
      if (frame.depth[i] > 2.5F) frame.depth[i] = 0.0F, frame.right_x[i] = std::numeric_limits<float>::quiet_NaN();
    return frame;
  };
  add_keyframe(without_far_depth(frame_at(beside(0))));
  Frame frame = frame_at(beside(0.3));
  match(frame, 1);
  add_keyframe(without_far_depth(frame));
  EXPECT_GT(mapper->counts().points_triangulated, 50U);
  int beyond = 0;
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    if (point.position.z() < 2.6) return;
    ++beyond;
    EXPECT_LT(point.position.z(), 4.4);  // where the world ends, with the noise of triangulation
  });
  EXPECT_GT(beyond, 50);
}

TEST_F(LocalMapperTest, APoseThatIsOffIsPulledBack) {
  add_keyframe(frame_at(beside(0)));
  Frame frame = frame_at(beside(0.1));
  match(frame, 1);
  frame.T_camera_world = beside(0.115).inverse();  // 15 mm off
  const KeyFrameId id = add_keyframe(frame);
  EXPECT_NEAR(map.keyframe(id).frame.T_world_camera().translation().x(), 0.1, 0.002);
}

TEST_F(LocalMapperTest, KeyframesThatShowNothingNewAreRemovedButNeverTheFirst) {
  KeyFrameId first;
  for (int k = 0; k < 12; ++k) {
    Frame frame = frame_at(beside(0.01 * k));
    match(frame, 1);
    const KeyFrameId id = add_keyframe(frame);
    if (k == 0) first = id;
  }
  EXPECT_LT(map.keyframes().size(), 8U);
  EXPECT_EQ(map.keyframes().size() + mapper->counts().keyframes_removed, 12U);
  EXPECT_NE(map.find_keyframe(first), nullptr);
}

TEST_F(LocalMapperTest, PointsThatNobodyFindsAgainLeave) {
  add_keyframe(frame_at(beside(0)));
  std::vector<MapPointId> missed;
  map.points().for_each([&](MapPointId id, const MapPoint&) {
    if (id.slot % 10 == 0) missed.push_back(id);
  });
  for (const MapPointId id : missed) map.point(id).visible_count = 20;
  Frame frame = frame_at(beside(0.02));
  match(frame, 1);
  add_keyframe(frame);
  for (const MapPointId id : missed) EXPECT_EQ(map.find_point(id), nullptr);
  EXPECT_GE(mapper->counts().points_removed, missed.size());
}

}  // namespace
}  // namespace holdfast
