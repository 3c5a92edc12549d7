// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/loop_closer.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "holdfast/plugin/registry.hpp"
#include "loop_closing/map_checks.hpp"
#include "loop_closing/ring_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr double round_trip = 2.0 * std::numbers::pi;

/// Ceres, with something happening while the pose graph is solved, or a pose graph without a solution.
class InterruptedOptimizer final : public Optimizer {
 public:
  explicit InterruptedOptimizer(Optimizer& optimizer) : optimizer_(optimizer) {}
  PoseSummary optimize_pose(PoseProblem& problem) override { return optimizer_.optimize_pose(problem); }
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    return optimizer_.optimize_bundle(problem, stop);
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override {
    if (meanwhile) meanwhile();
    return solvable ? optimizer_.optimize_pose_graph(problem) : GraphSummary{};
  }

  bool keeps_vertical() const override { return optimizer_.keeps_vertical(); }

  std::function<void()> meanwhile;
  bool solvable = true;

 private:
  Optimizer& optimizer_;
};

class LoopCloserTest : public testing::Test {
 protected:
  LoopCloserTest() {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    ceres = registry.create<Optimizer>("ceres", {}, {});
    optimizer = std::make_unique<InterruptedOptimizer>(*ceres);
    make_closer();
  }
  void make_closer() {
    closer =
        std::make_unique<LoopCloser>(settings, SharedMap{map, map_mutex, structure_mutex}, detector, *optimizer, 1);
  }
  /// Keyframes from one angle to another, each offered to the closer until it closes a loop.
  std::optional<ClosedLoop> walk(test::RingWorld& world, double from, double to, int keyframes) {
    for (int i = 0; i < keyframes; ++i) {
      const KeyFrameId id = world.add_keyframe(map, from + (to - from) * i / keyframes);
      if (knows_vertical && map.next_sequence() > 3)
        map.keyframe(id).vertical = Eigen::Vector3d::UnitY();  // cameras are upright
      error_before = world.largest_error(map);
      points_before = map.points().size();
      if (const auto loop = closer->process(id, times)) return loop;
    }
    return std::nullopt;
  }

  /// Largest angle by which a keyframe is tilted [rad].
  double largest_tilt() const {
    double largest = 0.0;
    map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
      const Eigen::Vector3d down = keyframe.frame.T_camera_world.linear() * Eigen::Vector3d::UnitY();
      largest = std::max(largest, down.cross(Eigen::Vector3d::UnitY()).norm());
    });
    return largest;
  }

  bool knows_vertical = false;
  LoopClosingSettings settings;
  Map map;
  MapMutex map_mutex;
  std::mutex structure_mutex;
  test::BruteForceDetector detector;
  std::unique_ptr<Optimizer> ceres;
  std::unique_ptr<InterruptedOptimizer> optimizer;
  std::unique_ptr<LoopCloser> closer;
  StageTimes times;
  double error_before = 0.0;
  std::size_t points_before = 0;
};

TEST_F(LoopCloserTest, DriftedRingIsPulledTogether) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  const auto loop = walk(world, 0, 1.2 * round_trip, 72);
  ASSERT_TRUE(loop);
  EXPECT_GT(error_before, 0.15);
  EXPECT_LT(world.largest_error(map), error_before / 5);
  EXPECT_LT(map.keyframe(loop->candidate).sequence, 15U);
  EXPECT_GT(loop->correction.metres, 0.1);
  EXPECT_GT(loop->points_fused, 100);
  EXPECT_LT(map.points().size(), points_before);
  EXPECT_EQ(closer->counts().of(LoopVerdict::closed), 1U);
  test::expect_consistent(map);
  // What was fused links both ends: tracking goes on with the old points.
  const auto& covisible = map.keyframe(loop->keyframe).covisible;
  EXPECT_TRUE(std::any_of(covisible.begin(), covisible.end(),
                          [&](const CovisibilityEdge& edge) { return edge.keyframe == loop->candidate; }));
  EXPECT_EQ(map.keyframe(loop->keyframe).loop_edges, std::vector<KeyFrameId>{loop->candidate});
}

TEST_F(LoopCloserTest, SameInputSameBits) {
  std::vector<Eigen::Matrix4d> first;
  for (int run = 0; run < 2; ++run) {
    map.clear();
    detector.clear();
    make_closer();
    test::RingWorld world;
    world.add_wall(0, round_trip, 2500);
    ASSERT_TRUE(walk(world, 0, 1.2 * round_trip, 72));
    std::vector<Eigen::Matrix4d> poses;
    map.keyframes().for_each(
        [&](KeyFrameId, const KeyFrame& keyframe) { poses.push_back(keyframe.frame.T_camera_world.matrix()); });
    if (run == 0)
      first = poses;
    else
      EXPECT_TRUE(first == poses);
  }
}

TEST_F(LoopCloserTest, APlaceSeenInTwoSubmapsJoinsThem) {
  // Lost for a while, the camera goes on where it believes to be: a metre and 40 degrees from where it is.
  test::RingWorld world(0.0);
  world.add_wall(0, round_trip, 2500);
  ASSERT_FALSE(walk(world, 0, 0.4 * round_trip, 24));
  Eigen::Isometry3d mistake = Eigen::Isometry3d::Identity();
  mistake.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY()).toRotationMatrix();
  mistake.translation() = Eigen::Vector3d(1.0, 0.1, 0.2);
  world.begin_submap(map, mistake);
  const auto loop = walk(world, 0.5 * round_trip, 1.2 * round_trip, 42);
  ASSERT_TRUE(loop);
  EXPECT_TRUE(loop->joins_submaps);
  EXPECT_GT(error_before, 0.9);
  EXPECT_LT(world.largest_error(map), 0.05);  // of 24 keyframes, which moved as one
  map.keyframes().for_each([](KeyFrameId, const KeyFrame& keyframe) { EXPECT_EQ(keyframe.submap, 0U); });
  test::expect_consistent(map);
}

TEST_F(LoopCloserTest, ALoopLeavesOtherSubmapsWhereTheyAre) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  walk(world, 0, 0.1 * round_trip, 6);
  const KeyFrameId of_first_submap = map.keyframes().ids().front();
  const Eigen::Matrix4d before = map.pose_of(of_first_submap).matrix();
  world.begin_submap(map, Eigen::Isometry3d(Eigen::Translation3d(1.0, 0.0, 0.0)));
  detector.clear();  // it recognises the second submap only
  const auto loop = walk(world, 0.2 * round_trip, 1.4 * round_trip, 72);
  ASSERT_TRUE(loop);
  EXPECT_FALSE(loop->joins_submaps);
  EXPECT_TRUE(map.pose_of(of_first_submap).matrix() == before);
  EXPECT_EQ(map.keyframe(loop->keyframe).submap, 1U);
}

TEST_F(LoopCloserTest, LookAlikePlaceIsRefused) {
  for (const bool is_inertial : {false, true}) {
    map.clear(), detector.clear(), make_closer();
    if (is_inertial) closer->use_inertia();
    // The wall opposite to the beginning is a copy of it: everything but the way agrees.
    test::RingWorld world;
    world.add_wall(0, 0.5 * round_trip, 1250);
    world.repeat_wall(0, 0.5 * round_trip, 0.5 * round_trip);
    EXPECT_FALSE(walk(world, 0.05 * round_trip, 0.95 * round_trip, 54));
    EXPECT_GT(closer->counts().of(LoopVerdict::implausible_correction), 3U);
    EXPECT_EQ(closer->counts().of(LoopVerdict::closed), 0U);
  }
}

/// Without inertial measurements, tracking would have been lost, and have begun another submap.
TEST_F(LoopCloserTest, DriftBehindAHiddenViewIsPlausibleWithInertia) {
  const Eigen::Isometry3d mistake(Eigen::Translation3d(0.5, 0.1, 0.7));
  for (const bool is_inertial : {false, true}) {
    map.clear(), detector.clear(), make_closer();
    if (is_inertial) closer->use_inertia();
    test::RingWorld world(0.0);
    world.add_wall(0, round_trip, 2500);
    ASSERT_FALSE(walk(world, 0, 0.5 * round_trip, 30));
    world.hide_view(mistake, 2.0);
    const auto loop = walk(world, 0.5 * round_trip, 1.2 * round_trip, 42);
    EXPECT_GT(error_before, 0.8);
    ASSERT_EQ(loop.has_value(), is_inertial);
    if (loop)
      EXPECT_GT(loop->correction.metres, 0.8);
    else
      EXPECT_GT(closer->counts().of(LoopVerdict::implausible_correction), 3U);
  }
}

/// Behind a hidden view, odometry is tilted. Spread over all keyframes, the tilt would also bend those before it.
TEST_F(LoopCloserTest, InertialMeasurementsKeepKeyframesUpright) {
  Eigen::Isometry3d mistake(Eigen::Translation3d(0.3, 0.0, 0.2));
  mistake.linear() = Eigen::AngleAxisd(0.07, Eigen::Vector3d::UnitX()).toRotationMatrix();
  knows_vertical = true;
  for (const bool keeps : {false, true}) {
    settings.keep_vertical = keeps;
    map.clear(), detector.clear(), make_closer();
    closer->use_inertia();
    test::RingWorld world(0.0);
    world.add_wall(0, round_trip, 2500);
    ASSERT_FALSE(walk(world, 0, 0.5 * round_trip, 30));
    world.hide_view(mistake, 2.0);
    ASSERT_TRUE(walk(world, 0.5 * round_trip, 1.2 * round_trip, 42));
    EXPECT_GT(error_before, 0.3);
    if (keeps)
      EXPECT_LT(largest_tilt(), 1e-9);
    else
      EXPECT_GT(largest_tilt(), 0.01);
  }
}

TEST_F(LoopCloserTest, WithoutMostVerticalsTheGraphHasSixDegreesOfFreedom) {
  Eigen::Isometry3d mistake(Eigen::Translation3d(0.3, 0.0, 0.2));
  mistake.linear() = Eigen::AngleAxisd(0.07, Eigen::Vector3d::UnitX()).toRotationMatrix();
  settings.keep_vertical = true;
  make_closer();
  closer->use_inertia();
  test::RingWorld world(0.0);
  world.add_wall(0, round_trip, 2500);
  knows_vertical = true;
  ASSERT_FALSE(walk(world, 0, 0.5 * round_trip, 30));
  knows_vertical = false;  // as in a map that goes on without an IMU
  world.hide_view(mistake, 2.0);
  ASSERT_TRUE(walk(world, 0.5 * round_trip, 1.2 * round_trip, 42));
  EXPECT_LT(largest_tilt(), 0.06) << "spread over all";
  EXPECT_GT(largest_tilt(), 0.01);
}

TEST_F(LoopCloserTest, SubmapsAreJoinedUpright) {
  test::RingWorld world(0.0);
  world.add_wall(0, round_trip, 2500);
  knows_vertical = settings.keep_vertical = true;
  make_closer();
  ASSERT_FALSE(walk(world, 0, 0.4 * round_trip, 24));
  Eigen::Isometry3d mistake(Eigen::Translation3d(1.0, 0.1, 0.2));
  mistake.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.4, 1.0, 0.1).normalized()).toRotationMatrix();
  world.begin_submap(map, mistake);
  const auto loop = walk(world, 0.5 * round_trip, 1.2 * round_trip, 42);
  ASSERT_TRUE(loop);
  EXPECT_TRUE(loop->joins_submaps);
  EXPECT_LT(largest_tilt(), 1e-9);
  EXPECT_LT(world.largest_error(map), 0.05);
}

TEST_F(LoopCloserTest, HiddenViewsDoNotMakeEveryDriftPlausible) {
  const Eigen::Isometry3d mistake(Eigen::Translation3d(3.5, 0.5, 2.5));
  closer->use_inertia();
  test::RingWorld world(0.0);
  world.add_wall(0, round_trip, 2500);
  ASSERT_FALSE(walk(world, 0, 0.3 * round_trip, 20));
  for (int i = 0; i < 4; ++i) {
    world.hide_view(i < 3 ? Eigen::Isometry3d::Identity() : mistake, 5.0);
    ASSERT_FALSE(walk(world, (0.3 + 0.05 * i) * round_trip, (0.35 + 0.05 * i) * round_trip, 5));
  }
  EXPECT_FALSE(walk(world, 0.5 * round_trip, 1.2 * round_trip, 60));
  EXPECT_GT(error_before, 4.0);
  EXPECT_GT(closer->counts().of(LoopVerdict::implausible_correction), 3U);
}

TEST_F(LoopCloserTest, LookAlikePlaceIsRefusedWhereOldPointsConfirmThePose) {
  // Any drift is believed, and the detector knows the copy only. But the second time round, the points of the original
  // lie where the present pose expects them.
  settings.drift_constant = 100.0;
  settings.turn_constant = 180.0;
  make_closer();
  test::RingWorld world(0.0);
  world.add_wall(0, 0.5 * round_trip, 1250);
  world.repeat_wall(0, 0.5 * round_trip, 0.5 * round_trip);
  for (int i = 0; i < 60; ++i) {
    const KeyFrameId id = world.add_keyframe(map, round_trip * i / 60);
    if (i >= 30) detector.add(id, map.keyframe(id).frame.features.descriptors);
  }
  EXPECT_FALSE(walk(world, 1.1 * round_trip, 1.3 * round_trip, 12));
  EXPECT_GT(closer->counts().of(LoopVerdict::pose_confirmed), 3U);
}

TEST_F(LoopCloserTest, PlaceWithoutGeometricAgreementIsRefused) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  ASSERT_FALSE(walk(world, 0, 0.9 * round_trip, 54));
  world.scramble();
  EXPECT_FALSE(walk(world, 0.9 * round_trip, 1.3 * round_trip, 24));
  const LoopCounts& counts = closer->counts();
  EXPECT_GT(
      counts.of(LoopVerdict::few_matches) + counts.of(LoopVerdict::no_alignment) + counts.of(LoopVerdict::few_inliers),
      0U);
}

TEST_F(LoopCloserTest, CameraThatStaysHasNoLoop) {
  test::RingWorld world(0.001);
  world.add_wall(0, round_trip, 2500);
  for (int i = 0; i < 60; ++i) {
    const KeyFrameId id = world.add_keyframe(map, 0.1 * std::sin(0.3 * i));
    EXPECT_FALSE(closer->process(id, times));
  }
  std::uint64_t looked_at = 0;
  for (const std::uint64_t count : closer->counts().verdicts) looked_at += count;
  EXPECT_EQ(looked_at, 0U);
}

TEST_F(LoopCloserTest, KeyframeAddedWhileTheGraphIsSolvedComesAlong) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  KeyFrameId added, parent;
  Eigen::Isometry3d T_added_parent;
  optimizer->meanwhile = [&] {
    const std::lock_guard lock(map_mutex);  // the map must be free for tracking
    const double angle = round_trip * 1.2 / 72 * static_cast<double>(map.next_sequence());
    added = world.add_keyframe(map, angle);
    parent = map.keyframe(added).parent;
    ASSERT_TRUE(parent.valid());
    T_added_parent = map.pose_of(added) * map.pose_of(parent).inverse();
  };
  const auto loop = walk(world, 0, 1.2 * round_trip, 72);
  ASSERT_TRUE(loop);
  ASSERT_TRUE(added.valid());
  EXPECT_TRUE(T_added_parent.isApprox(map.pose_of(added) * map.pose_of(parent).inverse(), 1e-9));
  EXPECT_LT(world.error_of(map, added), error_before / 5);
  EXPECT_LT(world.largest_error(map), error_before / 5);
  test::expect_consistent(map);
}

TEST_F(LoopCloserTest, UnsolvedGraphLeavesTheMapAlone) {
  optimizer->solvable = false;
  settings.pause = 0;
  make_closer();
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  EXPECT_FALSE(walk(world, 0, 1.05 * round_trip, 63));
  EXPECT_GT(closer->counts().of(LoopVerdict::not_solved), 0U);
  EXPECT_EQ(closer->counts().points_fused, 0U);
  map.keyframes().for_each([](KeyFrameId, const KeyFrame& keyframe) { EXPECT_TRUE(keyframe.loop_edges.empty()); });
  EXPECT_GT(world.largest_error(map), 0.2);
}

TEST_F(LoopCloserTest, NewLoopStopsAFullAdjustment) {
  FullAdjustment adjustment(settings, {map, map_mutex, structure_mutex}, *optimizer);
  closer->set_full_adjustment(&adjustment);
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  bool prepared = false;
  for (int i = 0; i < 72; ++i) {
    const KeyFrameId id = world.add_keyframe(map, 1.2 * round_trip * i / 72);
    if (i == 40) adjustment.prepare(), adjustment.solve(), prepared = true;
    if (closer->process(id, times)) break;
  }
  ASSERT_TRUE(prepared);
  ASSERT_EQ(closer->counts().of(LoopVerdict::closed), 1U);
  const Eigen::Matrix4d pose = map.pose_of(map.keyframes().ids()[20]).matrix();
  EXPECT_FALSE(adjustment.apply().applied);
  EXPECT_TRUE(pose == map.pose_of(map.keyframes().ids()[20]).matrix());
  const double error = world.largest_error(map);
  EXPECT_TRUE(adjustment.run().applied);
  EXPECT_LT(world.largest_error(map), error);
}

TEST_F(LoopCloserTest, KeyframesThatAreGoneArePassedOver) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  const KeyFrameId first = world.add_keyframe(map, 0.0);
  const KeyFrameId second = world.add_keyframe(map, 0.05);
  world.add_keyframe(map, 0.1);
  closer->process(first, times);
  map.remove_keyframe(second);
  EXPECT_FALSE(closer->process(second, times));
  EXPECT_EQ(detector.size(), 1U);
  EXPECT_EQ(closer->counts().removed, 1U);
  closer->forget(first);
  closer->forget(second);
  EXPECT_EQ(detector.size(), 0U);
}

TEST_F(LoopCloserTest, CandidatesThatLeftTheMapDoNotDisturb) {
  test::RingWorld world;
  world.add_wall(0, round_trip, 2500);
  ASSERT_FALSE(walk(world, 0, 0.9 * round_trip, 54));
  // Gone from the map, still known to the detector.
  for (const KeyFrameId id : map.keyframes().ids())
    if (map.keyframe(id).sequence % 2 == 1 && map.keyframe(id).sequence < 20) map.remove_keyframe(id);
  const auto loop = walk(world, 0.9 * round_trip, 1.2 * round_trip, 18);
  ASSERT_TRUE(loop);
  EXPECT_NE(map.find_keyframe(loop->candidate), nullptr);
  test::expect_consistent(map);
}

}  // namespace
}  // namespace holdfast
