// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/local_mapper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "holdfast/plugin/registry.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr double close_depth_factor = 40.0;  // baselines

/// A mapper over a world of points. Frames come without matches: what the map knows of them, fusion has to find out.
class LocalMapperTest : public testing::Test {
 protected:
  LocalMapperTest()
      : world(find_camera("tum_fr3").value(), 800),
        extractor(world, 0.2),
        depth(world.camera(), 0.0),
        builder(world.camera(), extractor, depth) {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    optimizer = registry.create<Optimizer>("ceres", {}, {});
    mapper = std::make_unique<LocalMapper>(MappingSettings{}, close_depth_factor, map, mutex, *optimizer);
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
        if (hamming_distance(point.descriptor.of_256_bits()[0], frame.features.descriptors.of_256_bits()[i]) < 40 &&
            found++ % n == 0)
          frame.map_points[i] = id;
      });
  }
  KeyFrameId add_keyframe(const Frame& frame) {
    const KeyFrameId keyframe = mapper->insert(MapAccess(map), frame, false, times);
    mapper->refine(keyframe, times);
    return keyframe;
  }
  /// Makes and removes 200 keyframes elsewhere, so that those of the map are not among the recent ones any more.
  void make_old(KeyFrameId parent) {
    for (int i = 0; i < 200; ++i) {
      const KeyFrameId other = map.add_keyframe(frame_at(beside(-50.0)));
      map.set_parent(other, parent);
      map.remove_keyframe(other);
    }
  }
  static Frame without_far_depth(Frame frame) {
    for (std::size_t i = 0; i < frame.size(); ++i)
      if (frame.depth[i] > 2.5F) frame.depth[i] = 0.0F, frame.right_x[i] = std::numeric_limits<float>::quiet_NaN();
    return frame;
  }
  static Eigen::Isometry3d beside(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); }

  test::PointWorld world;
  test::PointExtractor extractor;
  ImageDepth depth;
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

TEST_F(LocalMapperTest, AKeyframeThatMatchesNothingHangsOnTheLastOne) {
  // Its pose is by odometry: what both keyframes show is found by fusion.
  const KeyFrameId first = add_keyframe(frame_at(beside(0)));
  const std::size_t points = map.points().size();
  const KeyFrameId second = add_keyframe(frame_at(beside(0.05)));
  EXPECT_EQ(map.keyframe(second).parent, first);
  EXPECT_EQ(map.keyframe(first).children, std::vector<KeyFrameId>{second});
  EXPECT_LT(map.points().size(), points * 12 / 10);
  EXPECT_FALSE(map.keyframe(second).covisible.empty());
}

TEST_F(LocalMapperTest, FeaturesWithoutDepthAreTriangulated) {
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

TEST_F(LocalMapperTest, OneCameraTriangulatesFarFeaturesWithLittleParallaxIfAsked) {
  const auto triangulated = [&](double far_parallax) {
    MappingSettings settings;
    settings.far_parallax = far_parallax;
    map = Map();
    map.set_sensor(Sensor::mono);
    mapper = std::make_unique<LocalMapper>(settings, close_depth_factor, map, mutex, *optimizer);
    add_keyframe(without_far_depth(frame_at(beside(0))));
    Frame frame = frame_at(beside(0.05));  // beyond 2.5 m, the parallax is below 1.15 degrees
    match(frame, 1);
    add_keyframe(without_far_depth(frame));
    map.points().for_each([](MapPointId, const MapPoint& point) { EXPECT_LT(point.position.z(), 5.0); });
    return mapper->counts().points_triangulated;
  };
  EXPECT_LT(triangulated(1.15), 5U);
  EXPECT_GT(triangulated(0.1), 50U);
}

TEST_F(LocalMapperTest, APoseThatIsOffIsPulledBack) {
  add_keyframe(frame_at(beside(0)));
  Frame frame = frame_at(beside(0.1));
  match(frame, 1);
  frame.T_camera_world = beside(0.115).inverse();  // 15 mm off
  const KeyFrameId id = add_keyframe(frame);
  EXPECT_NEAR(map.keyframe(id).frame.T_world_camera().translation().x(), 0.1, 0.002);
}

/// Moves every free camera away, whatever the problem.
class Flight final : public Optimizer {
 public:
  explicit Flight(double distance = 0.8) : distance_(distance) {}
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>&) override {
    for (BundleProblem::Pose& pose : problem.poses)
      if (!pose.fixed) pose.T_camera_world.translation().x() += distance_;
    return {.usable = true};
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }

 private:
  double distance_;
};

/// Notes how far each bundle adjustment is to converge.
class Tolerances final : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>&) override {
    asked.push_back(problem.function_tolerance);
    return {.usable = true};
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }
  std::vector<double> asked;
};

TEST_F(LocalMapperTest, BundlesOfOneCameraConvergeFurther) {
  const auto asked = [&](Sensor sensor) {
    Tolerances tolerances;
    map = Map();
    map.set_sensor(sensor);
    mapper = std::make_unique<LocalMapper>(MappingSettings{}, close_depth_factor, map, mutex, tolerances);
    add_keyframe(frame_at(beside(0)));
    Frame frame = frame_at(beside(0.1));
    match(frame, 1);
    add_keyframe(frame);
    return tolerances.asked;
  };
  EXPECT_THAT(asked(Sensor::rgbd), ::testing::AllOf(::testing::Not(::testing::IsEmpty()), ::testing::Each(0.0)));
  EXPECT_THAT(asked(Sensor::mono), ::testing::AllOf(::testing::Not(::testing::IsEmpty()), ::testing::Each(1e-5)));
}

TEST_F(LocalMapperTest, AKeyframeThatFewPointsHoldDoesNotFlee) {
  Flight flight;
  LocalMapper fleeing(MappingSettings{}, close_depth_factor, map, mutex, flight);
  fleeing.refine(fleeing.insert(MapAccess(map), frame_at(beside(0)), false, times), times);
  // The second keyframe is so far aside that next to no point of the first one is still in view.
  for (const double x : {4.2, 0.1}) {
    Frame frame = frame_at(beside(x));
    match(frame, 1);
    const Eigen::Isometry3d before = frame.T_camera_world;
    const KeyFrameId id = fleeing.insert(MapAccess(map), frame, false, times);
    fleeing.refine(id, times);
    int shared = 0;
    for (const MapPointId point : map.keyframe(id).frame.map_points)
      shared += point.valid() && map.point(point).observations.size() > 1 ? 1 : 0;
    EXPECT_EQ(map.keyframe(id).frame.T_camera_world.isApprox(before, 1e-12), shared < 15) << shared;
    EXPECT_EQ(shared<15, x> 1.0) << shared;
  }
}

TEST_F(LocalMapperTest, InertialMeasurementsHoldAKeyframeThatFewPointsHold) {
  Flight flight(0.1);
  const auto moves = [&](double x, double deviation) {
    map.clear();
    LocalMapper fleeing(MappingSettings{}, close_depth_factor, map, mutex, flight);
    fleeing.refine(fleeing.insert(MapAccess(map), frame_at(beside(0)), false, times), times);
    Frame frame = frame_at(beside(x));
    match(frame, 1);
    frame.inertial_deviation = deviation;
    const Eigen::Isometry3d before = frame.T_camera_world;
    const KeyFrameId id = fleeing.insert(MapAccess(map), frame, false, times);
    fleeing.refine(id, times);
    return !map.keyframe(id).frame.T_camera_world.isApprox(before, 1e-12);
  };
  EXPECT_FALSE(moves(4.2, 0.003));
  EXPECT_TRUE(moves(4.2, 0.0)) << "nothing is known of its motion";
  EXPECT_TRUE(moves(4.2, 0.05)) << "the measurements allow it";
  EXPECT_TRUE(moves(0.1, 0.003)) << "ample points hold it";
}

TEST_F(LocalMapperTest, InertialMeasurementsHoldKeyframesThatHoldEachOtherAlone) {
  Flight flight(0.1);
  const auto moves = [&](double x) {
    map.clear();
    LocalMapper fleeing(MappingSettings{}, close_depth_factor, map, mutex, flight);
    fleeing.refine(fleeing.insert(MapAccess(map), frame_at(beside(-0.5 * x)), false, times), times);
    std::vector<std::pair<KeyFrameId, Eigen::Isometry3d>> behind;
    for (const double step : {0.0, 0.02}) {
      Frame frame = frame_at(beside(0.5 * x + step));
      match(frame, 1);
      frame.inertial_deviation = 0.003;
      const Eigen::Isometry3d pose = frame.T_camera_world;
      behind.emplace_back(fleeing.insert(MapAccess(map), frame, false, times), pose);
      fleeing.refine(behind.back().first, times);
    }
    int common = 0;
    for (const MapPointId point : map.keyframe(behind.front().first).frame.map_points)
      for (const Observation& seen : point.valid() ? map.point(point).observations : std::vector<Observation>())
        common += seen.keyframe == behind.back().first ? 1 : 0;
    EXPECT_GT(common, 30);
    int moved = 0;
    for (const auto& [id, pose] : behind) moved += map.keyframe(id).frame.T_camera_world.isApprox(pose, 1e-12) ? 0 : 1;
    return moved;
  };
  EXPECT_EQ(moves(4.0), 0) << "they share next to nothing with the first keyframe, and ample points with each other";
  EXPECT_EQ(moves(0.1), 2) << "ample points of the first keyframe hold them";
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

TEST_F(LocalMapperTest, KeyframesWithoutClosePointsAreRemovedOnceTheyAreOld) {
  // As among people who stand before a far wall: nothing that is seen lies within a baseline.
  LocalMapper far_mapper(MappingSettings{}, 1.0, map, mutex, *optimizer);
  const auto add = [&](double x) {
    Frame frame = frame_at(beside(x));
    match(frame, 1);
    const KeyFrameId keyframe = far_mapper.insert(MapAccess(map), frame, false, times);
    far_mapper.refine(keyframe, times);
    return keyframe;
  };
  const KeyFrameId first = add(0.0);
  for (int i = 1; i < 6; ++i) add(0.001 * i);
  ASSERT_EQ(map.keyframes().size(), 6U) << "the depth of recent ones is needed";
  make_old(first);
  const KeyFrameId last = add(0.006);
  EXPECT_LE(map.keyframes().size(), 5U);
  EXPECT_NE(map.find_keyframe(first), nullptr);
  EXPECT_NE(map.find_keyframe(last), nullptr);
}

TEST_F(LocalMapperTest, RarelyFoundPointsDoNotKeepAnOldKeyframe) {
  MappingSettings settings;
  settings.neighbours = 0;  // nothing is fused
  LocalMapper alone(settings, close_depth_factor, map, mutex, *optimizer);
  const auto add = [&](double x) {
    Frame frame = frame_at(beside(x));
    match(frame, 1);
    return alone.insert(MapAccess(map), frame, false, times);
  };
  const KeyFrameId first = add(0.0);
  std::array<KeyFrameId, 2> old{add(0.001), add(0.002)};
  for (int i = 3; i < 7; ++i) add(0.001 * i);
  // A fifth of the points of two keyframes is seen by nobody else; tracking finds those of the second.
  for (const KeyFrameId keyframe : old)
    for (std::uint32_t i = 0; i < map.keyframe(keyframe).frame.size(); i += 5) {
      const MapPointId shared = map.keyframe(keyframe).frame.map_points[i];
      if (!shared.valid()) continue;
      map.remove_observation(shared, keyframe);
      const MapPointId own = map.add_point(map.point(shared).position, 0);
      map.add_observation(own, keyframe, i);
      map.update_point(own);
      map.point(own).visible_count = 1000;
      map.point(own).found_count = keyframe == old[0] ? 10 : 500;
    }
  std::vector<MapPointId> shared;
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.observations.size() > 1) shared.push_back(id);
  });
  for (const MapPointId id : shared) {
    map.point(id).visible_count = 1000;
    map.point(id).found_count = 400;  // people hide all of them
  }
  alone.refine(add(0.008), times);
  ASSERT_NE(map.find_keyframe(old[0]), nullptr) << "it is recent";
  make_old(first);
  alone.refine(add(0.009), times);
  EXPECT_EQ(map.find_keyframe(old[0]), nullptr);
  EXPECT_NE(map.find_keyframe(old[1]), nullptr);
}

TEST_F(LocalMapperTest, AnOldKeyframeThatAddsLittleLeavesThoughItIsNobodysNeighbour) {
  const KeyFrameId first = add_keyframe(frame_at(beside(0)));
  std::vector<Frame> later;
  for (int k = 1; k <= 12; ++k) {
    later.push_back(frame_at(beside(0.1 * k)));
    match(later.back(), 1);
  }
  // Two views through a crowd: one feature of a hundred, and one of ten, has a point, which nobody else sees.
  std::array<KeyFrameId, 2> hidden;
  for (const std::uint32_t step : {100U, 10U}) {
    KeyFrameId& id = hidden[step == 100U ? 0 : 1];
    id = map.add_keyframe(frame_at(beside(0.001)));
    map.set_parent(id, first);
    for (std::uint32_t i = 0; i < map.keyframe(id).frame.size(); i += step) {
      const MapPointId own = map.add_point(Eigen::Vector3d(0, 0, 2), 0);
      map.add_observation(own, id, i);
      map.update_point(own);
    }
    ASSERT_TRUE(map.keyframe(id).covisible.empty());
  }
  for (int k = 0; k < 3; ++k) add_keyframe(later[k]);
  EXPECT_NE(map.find_keyframe(hidden[0]), nullptr) << "it is recent";
  make_old(first);
  for (int k = 3; k < 12; ++k) add_keyframe(later[k]);
  EXPECT_EQ(map.find_keyframe(hidden[0]), nullptr);
  EXPECT_NE(map.find_keyframe(hidden[1]), nullptr);
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

TEST_F(LocalMapperTest, WhatProbablyMovesMakesNoPoints) {
  const auto judged = [](Frame frame) {
    for (std::size_t i = 0; i < frame.size(); ++i) {
      frame.static_probability[i] = i % 2 == 0 ? 0.49F : 0.5F;
      if (frame.depth[i] > 2.5F) frame.depth[i] = 0.0F, frame.right_x[i] = std::numeric_limits<float>::quiet_NaN();
    }
    return frame;
  };
  const Frame first = judged(frame_at(beside(0)));
  const KeyFrameId id = add_keyframe(first);
  std::size_t with_depth = 0;
  for (std::size_t i = 1; i < first.size(); i += 2) with_depth += first.has_depth(i) ? 1 : 0;
  EXPECT_EQ(map.points().size(), with_depth);
  // Nor by triangulation, nor by being taken for points of others.
  Frame second = frame_at(beside(0.3));
  match(second, 1);
  const KeyFrameId next = add_keyframe(judged(second));
  EXPECT_GT(mapper->counts().points_triangulated, 20U);
  for (const KeyFrameId keyframe : {id, next}) {
    const Frame& kept = map.keyframe(keyframe).frame;
    for (std::size_t i = 0; i < kept.size(); i += 2) EXPECT_FALSE(kept.map_points[i].valid()) << i;
  }
}

TEST_F(LocalMapperTest, PointsThatWaitComeWithTheirMask) {
  const Frame frame = frame_at(beside(0));
  const KeyFrameId id = mapper->insert(MapAccess(map), frame, true, times);
  EXPECT_EQ(map.points().size(), 0U);
  // The mask comes between insertion and refinement.
  for (std::size_t i = 0; i < frame.size(); i += 3) map.keyframe(id).frame.static_probability[i] = 0.1F;
  mapper->refine(id, times);
  ASSERT_GT(map.points().size(), 100U);
  for (std::size_t i = 0; i < frame.size(); ++i)
    EXPECT_EQ(map.keyframe(id).frame.map_points[i].valid(), i % 3 != 0 && frame.depth[i] <= 3.2F && frame.has_depth(i));
}

TEST_F(LocalMapperTest, PointsOfLaterKeyframesStayUnlessAMaskMayContradictThem) {
  // Tracking inserts keyframes while mapping is busy with an older one.
  for (const bool expects_masks : {false, true}) {
    if (expects_masks) mapper->expect_masks();
    add_keyframe(frame_at(beside(0)));
    const KeyFrameId busy_with = mapper->insert(MapAccess(map), frame_at(beside(0.1)), false, times);
    const KeyFrameId later = mapper->insert(MapAccess(map), frame_at(beside(1.5)), false, times);
    const std::vector<MapPointId> made = map.keyframe(later).frame.map_points;
    mapper->refine(busy_with, times);
    std::size_t left = 0, all = 0;
    for (const MapPointId point : made) {
      all += point.valid() ? 1 : 0;
      left += map.find_point(point) != nullptr ? 1 : 0;
    }
    ASSERT_GT(all, 50U);
    EXPECT_EQ(left, expects_masks ? 0U : all);
    map.remove_all();
    mapper->forget_map();
  }
}

TEST_F(LocalMapperTest, AMaskTakesMatchesOfMovingFeaturesBack) {
  add_keyframe(frame_at(beside(0)));
  Frame frame = frame_at(beside(0.05));
  match(frame, 1);
  const KeyFrameId id = mapper->insert(MapAccess(map), frame, true, times);
  std::vector<std::pair<std::uint32_t, MapPointId>> masked;
  for (std::uint32_t i = 0; i < frame.size(); i += 4)
    if (frame.map_points[i].valid()) {
      masked.emplace_back(i, frame.map_points[i]);
      map.keyframe(id).frame.static_probability[i] = 0.1F;
    }
  ASSERT_GT(masked.size(), 20U);
  mapper->refine(id, times);
  for (const auto& [feature, point] : masked) {
    EXPECT_FALSE(map.keyframe(id).frame.map_points[feature].valid());
    EXPECT_NE(map.find_point(point), nullptr);  // the first keyframe saw it stand still
  }
}

TEST_F(LocalMapperTest, OneCameraDropsAPointThatAMaskLeavesWithTwoViews) {
  map.set_sensor(Sensor::mono);
  add_keyframe(frame_at(beside(0)));
  for (const double x : {0.05, 0.1, 0.15}) {
    Frame frame = frame_at(beside(x));
    match(frame, 1);
    mapper->insert(MapAccess(map), frame, false, times);
  }
  const KeyFrameId last = map.keyframes_by_age().back();
  std::vector<MapPointId> of_two, of_more;
  Frame& frame = map.keyframe(last).frame;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const MapPoint* point = map.find_point(frame.map_points[i]);
    if (point == nullptr || point->observations.size() < 3) continue;
    // The second of two groups keeps three other views.
    (point->observations.size() == 3 ? of_two : of_more).push_back(frame.map_points[i]);
    frame.static_probability[i] = 0.1F;
  }
  ASSERT_GT(of_more.size(), 20U);
  for (std::size_t i = 0; i < of_more.size() / 2; ++i) {
    map.remove_observation(of_more[i], map.keyframes_by_age().front());
    of_two.push_back(of_more[i]);
  }
  of_more.erase(of_more.begin(), of_more.begin() + static_cast<std::ptrdiff_t>(of_more.size() / 2));
  mapper->refine(last, times);
  for (const MapPointId point : of_two) EXPECT_EQ(map.find_point(point), nullptr);
  std::size_t left = 0;
  for (const MapPointId point : of_more) left += map.find_point(point) != nullptr ? 1 : 0;
  EXPECT_GT(left, of_more.size() * 8 / 10);
}

TEST_F(LocalMapperTest, PointsThatWereFoundToMoveLeave) {
  add_keyframe(frame_at(beside(0)));
  std::vector<MapPointId> moving, doubtful;
  map.points().for_each([&](MapPointId id, const MapPoint&) {
    if (id.slot % 7 == 0) moving.push_back(id);
    if (id.slot % 7 == 1) doubtful.push_back(id);
  });
  for (const MapPointId id : moving) map.point(id).static_log_odds = -2.01F;
  for (const MapPointId id : doubtful) map.point(id).static_log_odds = -1.99F;
  Frame frame = frame_at(beside(0.02));
  match(frame, 1);
  add_keyframe(frame);
  for (const MapPointId id : moving) EXPECT_EQ(map.find_point(id), nullptr);
  EXPECT_EQ(mapper->counts().points_moving, moving.size());
  std::size_t left = 0;
  for (const MapPointId id : doubtful) left += map.find_point(id) != nullptr ? 1 : 0;
  EXPECT_GT(left, doubtful.size() * 9 / 10);
}

}  // namespace
}  // namespace holdfast
