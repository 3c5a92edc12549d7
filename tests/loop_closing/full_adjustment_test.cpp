// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/full_adjustment.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <limits>

#include "holdfast/plugin/registry.hpp"
#include "loop_closing/map_checks.hpp"
#include "loop_closing/ring_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

std::unique_ptr<Optimizer> make_optimizer() {
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  return registry.create<Optimizer>("ceres", {}, {});
}

class FullAdjustmentTest : public testing::Test {
 protected:
  FullAdjustmentTest() {
    world.add_wall(0, 2.0 * std::numbers::pi, 1500);
    for (int i = 0; i < 20; ++i) last = world.add_keyframe(map, 0.1 * i);
  }
  double mean_error() const {
    double sum = 0.0;
    map.keyframes().for_each([&](KeyFrameId id, const KeyFrame&) { sum += world.error_of(map, id); });
    return sum / static_cast<double>(map.keyframes().size());
  }

  test::RingWorld world;
  Map map;
  MapMutex map_mutex;
  std::mutex structure_mutex;
  std::unique_ptr<Optimizer> optimizer = make_optimizer();
  FullAdjustment adjustment{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, *optimizer};
  KeyFrameId last;
};

TEST_F(FullAdjustmentTest, LowersTheErrorOfTheMap) {
  const double before = mean_error();
  const std::uint64_t version = map.version();
  const FullAdjustmentSummary summary = adjustment.run();
  EXPECT_TRUE(summary.applied);
  EXPECT_FALSE(summary.stop_requested);
  EXPECT_EQ(summary.keyframes, 20);
  EXPECT_EQ(summary.points, static_cast<int>(map.points().size()));
  EXPECT_LT(summary.bundle.final_cost, summary.bundle.initial_cost);
  EXPECT_LT(mean_error(), before / 3);
  EXPECT_GT(map.version(), version);
  EXPECT_TRUE(map.keyframe(map.keyframes().ids().front())
                  .frame.T_camera_world.isApprox(test::RingWorld::pose_at(0).inverse(), 1e-12));
  test::expect_consistent(map);
}

TEST_F(FullAdjustmentTest, AKeyframeWithFewPointsStaysWithItsParent) {
  // Ten points, of which the matches are wrong: alone, the keyframe would follow them.
  std::vector<MapPointId> points;
  for (const MapPointId point : map.keyframe(last).frame.map_points)
    if (point.valid() && map.point(point).observations.size() > 1) points.push_back(point);
  ASSERT_GT(points.size(), 20U);
  for (std::size_t i = 10; i < points.size(); ++i) map.remove_observation(points[i], last);
  Frame& frame = map.keyframe(last).frame;
  for (std::size_t i = 0; i < frame.size(); ++i) frame.x[i] += 40.0F, frame.right_x[i] += 40.0F;
  const KeyFrameId parent = map.keyframe(last).parent;
  ASSERT_TRUE(parent.valid());
  const Eigen::Isometry3d relative = map.pose_of(last) * map.pose_of(parent).inverse();
  const FullAdjustmentSummary summary = adjustment.run();
  EXPECT_TRUE(summary.applied);
  EXPECT_EQ(summary.keyframes, 19);
  EXPECT_EQ(summary.keyframes_carried, 1);
  EXPECT_TRUE((map.pose_of(last) * map.pose_of(parent).inverse()).isApprox(relative, 1e-9));
}

/// Measurements of an IMU at the camera of RingWorld, which turns by 0.1 rad in each second.
/// Nothing is measured in the second before `gap`.
std::unique_ptr<InertialHistory> measured_ring(int gap = -1) {
  auto history = std::make_unique<InertialHistory>(*find_imu("bmi055"));
  for (int second = 0; second < 20; ++second) {
    if (second == gap) continue;
    SensorFrame frame;
    frame.timestamp = second;
    for (int i = -201; i <= 1; ++i)
      frame.imu.push_back({second + 0.005 * i, {0.0, 0.1, 0.0}, {0.0, -standard_gravity, -0.015}});
    history->add(frame);
  }
  MapInertia estimates;
  estimates.gravity = {0.0, standard_gravity, 0.0};
  history->set_estimates(estimates, 0);
  return history;
}

TEST_F(FullAdjustmentTest, InertialMeasurementsPlaceKeyframesWithoutPoints) {
  std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  for (std::size_t i = 9; i < 12; ++i) {
    for (const MapPointId point : std::vector<MapPointId>(map.keyframe(keyframes[i]).frame.map_points))
      if (point.valid()) map.remove_observation(point, keyframes[i]);
    map.keyframe(keyframes[i]).frame.T_camera_world.translation().x() += 0.1;
  }
  const std::unique_ptr<InertialHistory> history = measured_ring();
  adjustment.use_inertia(*history);
  const FullAdjustmentSummary summary = adjustment.run();
  ASSERT_TRUE(summary.applied);
  EXPECT_EQ(summary.keyframes, 20);
  for (std::size_t i = 9; i < 12; ++i) EXPECT_LT(world.error_of(map, keyframes[i]), 0.01) << i;
  EXPECT_EQ(adjustment.placed_keyframes().size(), 19U) << "all but the first, which is fixed";
}

TEST_F(FullAdjustmentTest, KeepsVelocitiesOfTheKeyframesThatItLinks) {
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  ASSERT_TRUE(adjustment.run().applied);
  for (const KeyFrameId id : keyframes) EXPECT_FALSE(map.keyframe(id).motion) << "without measurements";
  const std::unique_ptr<InertialHistory> history = measured_ring();
  adjustment.use_inertia(*history);
  ASSERT_TRUE(adjustment.run().applied);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    ASSERT_TRUE(map.keyframe(keyframes[i]).motion) << i;
    const Eigen::Isometry3d truth = test::RingWorld::pose_at(0.1 * static_cast<double>(i));
    const Eigen::Vector3d expected = Eigen::Vector3d(0.0, 0.1, 0.0).cross(truth.translation());
    EXPECT_LT((map.keyframe(keyframes[i]).motion->velocity - expected).norm(), 0.01) << i;
    ASSERT_TRUE(map.keyframe(keyframes[i]).vertical) << i;
    EXPECT_GT(map.keyframe(keyframes[i]).vertical->dot(truth.linear() * Eigen::Vector3d::UnitY()), std::cos(0.01)) << i;
  }
}

TEST_F(FullAdjustmentTest, AKeyframeThatFollowsItsParentWasNotPlaced) {
  for (const MapPointId point : std::vector<MapPointId>(map.keyframe(last).frame.map_points))
    if (point.valid()) map.remove_observation(point, last);
  const std::unique_ptr<InertialHistory> history = measured_ring(19);
  adjustment.use_inertia(*history);
  ASSERT_TRUE(adjustment.run().applied);
  const std::vector<double> placed = adjustment.placed_keyframes();
  EXPECT_EQ(placed.size(), 18U);
  EXPECT_EQ(std::count(placed.begin(), placed.end(), map.keyframe(last).frame.timestamp), 0);
  adjustment.cancel();
  EXPECT_FALSE(adjustment.run().applied);
  EXPECT_TRUE(adjustment.placed_keyframes().empty());
}

/// Cannot use factors, although it has no reason to.
class OnlyVisual final : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    factors.push_back(problem.factors.inertial.size());
    return problem.factors.empty() ? optimizer_->optimize_bundle(problem, stop) : BundleSummary{};
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }

  std::vector<std::size_t> factors;  ///< inertial ones by call

 private:
  std::unique_ptr<Optimizer> optimizer_ = make_optimizer();
};

TEST_F(FullAdjustmentTest, AdjustsWithoutFactorsThatCannotBeUsed) {
  const double before = mean_error();
  OnlyVisual visual;
  FullAdjustment twice{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, visual};
  const std::unique_ptr<InertialHistory> history = measured_ring();
  twice.use_inertia(*history);
  EXPECT_TRUE(twice.run().applied);
  EXPECT_EQ(visual.factors, (std::vector<std::size_t>{19, 0}));
  EXPECT_LT(mean_error(), before);
}

/// Solves once and fails then.
class OnlyOnce final : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    ++calls;
    tolerances.push_back(problem.function_tolerance);
    if (calls > 1) return {};
    const BundleSummary summary = optimizer_->optimize_bundle(problem, stop);
    last = problem.poses.back().T_camera_world;
    observations = problem.observations.size();
    outliers = summary.outliers;
    return summary;
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }

  int calls = 0, outliers = 0;
  std::vector<double> tolerances;  ///< by call
  Eigen::Isometry3d last;
  std::size_t observations = 0;

 private:
  std::unique_ptr<Optimizer> optimizer_ = make_optimizer();
};

/// Leaves the last four keyframes few points in common with the others.
void leave_few_ties(Map& map, std::size_t count) {
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  const std::uint64_t first = map.keyframe(keyframes[keyframes.size() - 4]).sequence;
  std::size_t kept = 0;
  for (const MapPointId id : map.points().ids()) {
    const std::vector<Observation> seen(map.point(id).observations.begin(), map.point(id).observations.end());
    const auto is_late = [&](const Observation& other) { return map.keyframe(other.keyframe).sequence >= first; };
    if (std::all_of(seen.begin(), seen.end(), is_late) || std::none_of(seen.begin(), seen.end(), is_late)) continue;
    if (kept++ < count) continue;
    for (const Observation& other : seen)
      if (is_late(other) && map.find_point(id) != nullptr) map.remove_observation(id, other.keyframe);
  }
  for (const KeyFrameId id : keyframes) map.update_covisibility(id);
}

TEST_F(FullAdjustmentTest, TheSolutionWithoutTiesStaysIfThatWithThemFails) {
  leave_few_ties(map, 20);
  OnlyOnce once;
  FullAdjustment tied{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, once};
  const std::unique_ptr<InertialHistory> history = measured_ring();
  tied.use_inertia(*history);
  const FullAdjustmentSummary summary = tied.run();
  EXPECT_TRUE(summary.applied);
  ASSERT_EQ(once.calls, 2) << "with ties, and none without inertia";
  EXPECT_LT(once.observations, static_cast<std::size_t>(summary.observations));
  EXPECT_GE(once.tolerances[0], 100.0 * LoopClosingSettings{}.full_tolerance) << "it only sorts ties";
  EXPECT_EQ(once.tolerances[1], LoopClosingSettings{}.full_tolerance);
  EXPECT_TRUE(map.pose_of(last).isApprox(once.last, 1e-12));
}

TEST_F(FullAdjustmentTest, RejectedTiesAreOutliers) {
  leave_few_ties(map, 20);
  Frame& frame = map.keyframe(last).frame;
  for (std::size_t i = 0; i < frame.size(); ++i) frame.y[i] += 60.0F;
  OnlyOnce once;
  FullAdjustment tied{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, once};
  const std::unique_ptr<InertialHistory> history = measured_ring();
  tied.use_inertia(*history);
  EXPECT_GT(tied.run().bundle.outliers, once.outliers);
}

/// Moves the last camera far away, whatever the problem.
class Flight final : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>&) override {
    problem.poses.back().T_camera_world.translation().x() += 0.5;
    return {.usable = true};
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }
};

TEST_F(FullAdjustmentTest, AKeyframeThatFewPointsHoldDoesNotFlee) {
  std::vector<MapPointId> points;
  for (const MapPointId point : map.keyframe(last).frame.map_points)
    if (point.valid() && map.point(point).observations.size() > 1) points.push_back(point);
  ASSERT_GT(points.size(), 70U);
  const KeyFrameId parent = map.keyframe(last).parent;
  Flight flight;
  FullAdjustment fleeing{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, flight};
  for (const std::size_t left : {70U, 40U}) {
    for (std::size_t i = left; i < points.size(); ++i) map.remove_observation(points[i], last);
    points.resize(left);
    const Eigen::Isometry3d relative = map.pose_of(last) * map.pose_of(parent).inverse();
    const FullAdjustmentSummary summary = fleeing.run();
    EXPECT_TRUE(summary.applied);
    EXPECT_EQ(summary.keyframes, 20);
    const bool stays = (map.pose_of(last) * map.pose_of(parent).inverse()).isApprox(relative, 1e-9);
    EXPECT_EQ(stays, left < 60) << left;
    EXPECT_EQ(summary.keyframes_carried, stays ? 1 : 0);
  }
}

/// Takes from the last four keyframes what they share with the others.
std::vector<KeyFrameId> make_island(Map& map) {
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  const std::vector<KeyFrameId> island(keyframes.end() - 4, keyframes.end());
  const std::uint64_t first = map.keyframe(island.front()).sequence;
  for (const KeyFrameId id : island)
    for (const MapPointId point : std::vector<MapPointId>(map.keyframe(id).frame.map_points)) {
      if (!point.valid()) continue;
      const auto is_older = [&](const Observation& other) { return map.keyframe(other.keyframe).sequence < first; };
      const auto& seen = map.point(point).observations;
      if (std::any_of(seen.begin(), seen.end(), is_older)) map.remove_observation(point, id);
    }
  for (const KeyFrameId id : keyframes) map.update_covisibility(id);
  return island;
}

/// Makes the map twice as large.
class Doubling final : public Optimizer {
 public:
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>&) override {
    for (BundleProblem::Pose& pose : problem.poses) pose.T_camera_world.translation() *= 2.0;
    for (Eigen::Vector3d& point : problem.points) point *= 2.0;
    return {.usable = true};
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }
};

TEST_F(FullAdjustmentTest, FramesFollowTheUnitOfOneCamerasMapAndNotThatOfDepth) {
  Doubling doubling;
  FullAdjustment doubled{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, doubling};
  for (const bool has_depth : {true, false}) {
    for (const KeyFrameId id : map.keyframes().ids()) {
      KeyFrame& keyframe = map.keyframe(id);
      keyframe.scale = 1.0;
      if (!has_depth)
        std::fill(keyframe.frame.right_x.begin(), keyframe.frame.right_x.end(),
                  std::numeric_limits<float>::quiet_NaN());
    }
    EXPECT_TRUE(doubled.run().applied);
    for (const KeyFrameId id : map.keyframes().ids())
      EXPECT_NEAR(map.keyframe(id).scale, has_depth ? 1.0 : 2.0, 1e-9) << has_depth;
  }
}

TEST_F(FullAdjustmentTest, AnIslandOfKeyframesKeepsItsPlace) {
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age(), island = make_island(map);
  ASSERT_FALSE(map.keyframe(island.front()).covisible.empty());
  const Eigen::Isometry3d place = map.pose_of(island.front()), other = map.pose_of(keyframes[10]);
  EXPECT_TRUE(adjustment.run().applied);
  EXPECT_TRUE(map.pose_of(island.front()).isApprox(place, 1e-12)) << "nothing else fixes its gauge";
  EXPECT_FALSE(map.pose_of(keyframes[10]).isApprox(other, 1e-6));
}

/// Links within the island do not place it.
TEST_F(FullAdjustmentTest, AnIslandMovesOnlyIfALinkJoinsItToTheMap) {
  const std::vector<KeyFrameId> island = make_island(map);
  const Eigen::Isometry3d place = map.pose_of(island.front());
  for (const int gap : {16, -1}) {
    FullAdjustment linked{LoopClosingSettings{}, {map, map_mutex, structure_mutex}, *optimizer};
    const std::unique_ptr<InertialHistory> history = measured_ring(gap);
    linked.use_inertia(*history);
    EXPECT_TRUE(linked.run().applied);
    EXPECT_EQ(map.pose_of(island.front()).isApprox(place, 1e-12), gap == 16) << gap;
  }
}

/// Bytes that the process has allocated and not freed.
std::size_t allocated() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// The next adjustment may be far away, or never come.
TEST_F(FullAdjustmentTest, KeepsNoCopyOfTheMap) {
  if (allocated() == 0) GTEST_SKIP() << "this allocator does not say how much it gave";
  adjustment.run();  // what libraries allocate once
  const std::size_t before = allocated();
  adjustment.prepare();
  const std::size_t with_copy = allocated();
  ASSERT_GT(with_copy, before + 32 * map.points().size());
  adjustment.solve();
  adjustment.apply();
  EXPECT_LT(allocated(), before + (with_copy - before) / 10);
}

TEST_F(FullAdjustmentTest, StoppedOneChangesNothing) {
  const Eigen::Matrix4d before = map.pose_of(last).matrix();
  adjustment.prepare();
  adjustment.request_stop();
  adjustment.solve();
  const FullAdjustmentSummary summary = adjustment.apply();
  EXPECT_TRUE(summary.stop_requested);
  EXPECT_FALSE(summary.applied);
  EXPECT_TRUE(map.pose_of(last).matrix() == before);
  EXPECT_TRUE(adjustment.run().applied);  // and the next one starts afresh
}

TEST_F(FullAdjustmentTest, ACancelledOneDoesNotBeginAgain) {
  // A run that is interrupted still works off what waits, and that may close another loop.
  adjustment.cancel();
  const FullAdjustmentSummary summary = adjustment.run();
  EXPECT_TRUE(summary.stop_requested);
  EXPECT_FALSE(summary.applied);
  EXPECT_EQ(summary.bundle.iterations, 0);
}

TEST_F(FullAdjustmentTest, StopAfterTheSolverStillCounts) {
  // A loop that was closed in between has moved the map: the result belongs to the map of before.
  const Eigen::Matrix4d before = map.pose_of(last).matrix();
  adjustment.prepare();
  adjustment.solve();
  adjustment.request_stop();
  EXPECT_FALSE(adjustment.apply().applied);
  EXPECT_TRUE(map.pose_of(last).matrix() == before);
}

TEST_F(FullAdjustmentTest, WhatCameMeanwhileFollowsAndWhatLeftIsPassedOver) {
  adjustment.prepare();
  adjustment.solve();

  const KeyFrameId added = world.add_keyframe(map, 2.0);
  const KeyFrameId parent = map.keyframe(added).parent;
  ASSERT_TRUE(parent.valid());
  MapPointId new_point;
  Eigen::Vector3d new_point_in_camera;
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.reference_keyframe != added) return;
    new_point = id;
    new_point_in_camera = map.pose_of(added) * point.position;
  });
  ASSERT_TRUE(new_point.valid());
  const Eigen::Isometry3d T_added_parent = map.pose_of(added) * map.pose_of(parent).inverse();
  const Eigen::Matrix4d parent_before = map.pose_of(parent).matrix();

  const KeyFrameId removed = map.keyframes().ids()[10];
  ASSERT_NE(removed, parent);
  map.remove_keyframe(removed);
  for (const MapPointId id : map.points().ids())
    if (id.slot % 7 == 0 && id != new_point) map.remove_point(id);

  const FullAdjustmentSummary summary = adjustment.apply();
  EXPECT_TRUE(summary.applied);
  EXPECT_EQ(summary.keyframes_carried, 1);
  EXPECT_FALSE(map.pose_of(parent).matrix() == parent_before);
  EXPECT_TRUE(T_added_parent.isApprox(map.pose_of(added) * map.pose_of(parent).inverse(), 1e-9));
  EXPECT_LT((map.pose_of(added) * map.point(new_point).position - new_point_in_camera).norm(), 1e-9);
  EXPECT_LT(world.error_of(map, added), 0.03);
  test::expect_consistent(map);
}

TEST_F(FullAdjustmentTest, OutlyingObservationsLeaveTheMap) {
  // A feature that shows something else than its point.
  const MapPointId point = [&] {
    MapPointId found;
    map.points().for_each([&](MapPointId id, const MapPoint& p) {
      if (p.observations.size() >= 5 && !found.valid()) found = id;
    });
    return found;
  }();
  ASSERT_TRUE(point.valid());
  const Observation wrong = map.point(point).observations.back();
  map.keyframe(wrong.keyframe).frame.x[wrong.feature] += 25.0F;
  EXPECT_GE(adjustment.run().bundle.outliers, 1);
  ASSERT_NE(map.find_point(point), nullptr);
  EXPECT_EQ(map.feature_of(point, wrong.keyframe), -1);
  test::expect_consistent(map);
}

TEST_F(FullAdjustmentTest, EmptyMapIsLeftAlone) {
  map.clear();
  EXPECT_FALSE(adjustment.run().applied);
}

}  // namespace
}  // namespace holdfast
