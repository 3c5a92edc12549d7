// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <limits>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/registry.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

PipelineParts parts_for(test::PointWorld& world, double pixel_noise) {
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  PipelineParts parts;
  parts.camera = world.camera();
  parts.features = std::make_unique<test::PointExtractor>(world, pixel_noise);
  parts.optimizer = registry.create<Optimizer>("ceres", {}, {});
  return parts;
}

double largest_error(const Trajectory& trajectory) {
  double largest = 0.0;
  for (const TimedPose& pose : trajectory)
    largest =
        std::max(largest, (pose.T_world_camera.translation() - test::path_pose(pose.timestamp).translation()).norm());
  return largest;
}

TEST(Pipeline, FollowsACameraThroughAWorldOfPoints) {
  test::PointWorld world(find_camera("tum_fr1").value());
  Pipeline pipeline(parts_for(world, 0.3));
  constexpr int frames = 120;
  for (int i = 0; i < frames; ++i) {
    const double time = i / 30.0;
    const FrameResult result = pipeline.feed(world.frame(static_cast<std::uint64_t>(i), time, test::path_pose(time)));
    EXPECT_EQ(result.status, i == 0 ? TrackingStatus::initialised : TrackingStatus::tracked) << i;
    ASSERT_TRUE(result.T_world_camera.has_value());
  }
  pipeline.finish();
  ASSERT_EQ(pipeline.trajectory().size(), static_cast<std::size_t>(frames));
  EXPECT_LT(largest_error(pipeline.trajectory()), 0.004);
  EXPECT_GE(pipeline.map().keyframes().size(), 2U);
  EXPECT_EQ(pipeline.keyframe_trajectory().size(), pipeline.map().keyframes().size());
}

TEST(Pipeline, ARefusedFrameLeavesNoTrace) {
  const auto run = [](bool with_refused_frames) {
    test::PointWorld world(find_camera("tum_fr1").value());
    Pipeline pipeline(parts_for(world, 0.5));
    const auto expect_refused = [&](const SensorFrame& frame) {
      EXPECT_THROW(pipeline.feed(frame), InputError) << frame.index;
    };
    for (int i = 0; i < 30; ++i) {
      const double time = i / 30.0;
      const SensorFrame frame = world.frame(static_cast<std::uint64_t>(i), time, test::path_pose(time));
      if (with_refused_frames && i % 10 == 0) {
        SensorFrame refused = frame;
        refused.timestamp = std::numeric_limits<double>::quiet_NaN();
        expect_refused(refused);
        refused.timestamp = std::numeric_limits<double>::infinity();
        expect_refused(refused);
        refused = frame;
        refused.colour = frame.colour.colRange(0, 8);
        expect_refused(refused);  // and its stamp is free for the same frame with its image
        refused.colour = cv::Mat();
        expect_refused(refused);
      }
      pipeline.feed(frame);
      if (with_refused_frames && i % 10 == 5) expect_refused(frame);  // its stamp has been used
    }
    return pipeline.trajectory();
  };
  const Trajectory clean = run(false), disturbed = run(true);
  ASSERT_EQ(disturbed.size(), clean.size());
  for (std::size_t i = 0; i < clean.size(); ++i)
    EXPECT_EQ(disturbed[i].T_world_camera.matrix(), clean[i].T_world_camera.matrix()) << i;
}

TEST(Pipeline, TwoRunsGiveTheSameBits) {
  const auto run = [] {
    test::PointWorld world(find_camera("tum_fr1").value());
    Pipeline pipeline(parts_for(world, 0.5));
    for (int i = 0; i < 60; ++i)
      pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
    return pipeline.trajectory();
  };
  const Trajectory first = run(), second = run();
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_EQ(first[i].T_world_camera.matrix(), second[i].T_world_camera.matrix()) << i;
}

TEST(Pipeline, LostInTheDarkIsAResultAndLightBringsItBack) {
  test::PointWorld world(find_camera("tum_fr1").value());
  Pipeline pipeline(parts_for(world, 0.3));
  int lost = 0, recovered = 0;
  for (int i = 0; i < 90; ++i) {
    const double time = i / 30.0;
    const bool dark = i >= 40 && i < 60;
    const FrameResult result =
        pipeline.feed(world.frame(static_cast<std::uint64_t>(i), time, test::path_pose(time), !dark));
    EXPECT_EQ(result.status == TrackingStatus::lost, dark) << i;
    EXPECT_EQ(result.T_world_camera.has_value(), !dark) << i;
    EXPECT_EQ(result.failure != TrackingFailure::none, dark) << i;
    lost += result.status == TrackingStatus::lost ? 1 : 0;
    recovered += result.method == TrackingMethod::recovered && !dark ? 1 : 0;
  }
  EXPECT_EQ(lost, 20);
  EXPECT_EQ(recovered, 1);
  EXPECT_EQ(pipeline.trajectory().size(), 70U);
  EXPECT_LT(largest_error(pipeline.trajectory()), 0.006);
}

TEST(Pipeline, ThreadsDoTheSameWork) {
  for (const Pace pace : {Pace::none, Pace::timestamps}) {
    test::PointWorld world(find_camera("tum_fr1").value());
    PipelineParts parts = parts_for(world, 0.3);
    parts.loop_detector = std::make_unique<test::BruteForceDetector>();
    parts.run = {.mode = RunMode::threaded, .pace = pace, .keyframe_queue = 2};
    Pipeline pipeline(std::move(parts));
    constexpr int frames = 120;
    for (int i = 0; i < frames; ++i) {
      const double time = i / 30.0;
      const bool dark = i >= 50 && i < 55;
      const FrameResult result =
          pipeline.feed(world.frame(static_cast<std::uint64_t>(i), time, test::path_pose(time), !dark));
      EXPECT_EQ(result.T_world_camera.has_value(), !dark) << i;
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.trajectory().size(), 115U);
    EXPECT_LT(largest_error(pipeline.trajectory()), 0.006);
    EXPECT_FALSE(pipeline.take_background_times().empty());
    const std::vector<WorkerCounts> workers = pipeline.worker_counts();
    ASSERT_EQ(workers.size(), 3U);  // local mapping, loop closing, full adjustment
    EXPECT_EQ(workers[0].queue.taken, pipeline.mapping_counts().keyframes_made);
    EXPECT_TRUE(pace == Pace::timestamps || pipeline.keyframes_deferred() == 0);
  }
}

TEST(Pipeline, ThreadsEndCleanlyInTheMiddleOfARun) {
  test::PointWorld world(find_camera("tum_fr1").value());
  for (int frames = 0; frames < 12; ++frames) {
    PipelineParts parts = parts_for(world, 0.3);
    parts.run.mode = RunMode::threaded;
    Pipeline pipeline(std::move(parts));
    for (int i = 0; i < frames; ++i)
      pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 10.0, test::path_pose(i / 10.0)));
  }
}

/// Throws when it is told of the second keyframe.
class Thrower final : public Observer {
 public:
  void on_keyframe(KeyFrameId, const ObservedMap&) override {
    if (++keyframes_ == 2) throw InputError({"disk"}, "is full");
  }

 private:
  int keyframes_ = 0;
};

TEST(Pipeline, WhatAThreadThrowsComesBack) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineParts parts = parts_for(world, 0.3);
  parts.run.mode = RunMode::threaded;
  parts.observers.push_back(std::make_unique<Thrower>());
  Pipeline pipeline(std::move(parts));
  const auto run = [&] {
    for (int i = 0; i < 120; ++i)
      pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
    pipeline.finish();
  };
  EXPECT_THROW(run(), InputError);
}

/// Blocks in on_keyframe() until it is released, as a viewer may that draws slowly. It takes a snapshot first.
class SlowViewer final : public Observer {
 public:
  struct Gate {
    std::promise<void> blocked, released;
    bool gave_up = false;
  };
  explicit SlowViewer(Gate& gate) : gate_(gate) {}
  void on_keyframe(KeyFrameId, const ObservedMap& map) override {
    if (entered_) return;
    entered_ = true;
    EXPECT_FALSE(map.snapshot().points.empty());
    EXPECT_EQ(&map.snapshot(), &map.snapshot());
    gate_.blocked.set_value();
    gate_.gave_up = gate_.released.get_future().wait_for(std::chrono::seconds(60)) != std::future_status::ready;
  }

 private:
  Gate& gate_;
  bool entered_ = false;
};

TEST(Pipeline, ASlowObserverStallsNeitherTrackingNorSnapshots) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineParts parts = parts_for(world, 0.3);
  parts.run.mode = RunMode::threaded;
  parts.run.pace = Pace::timestamps;
  SlowViewer::Gate gate;
  parts.observers.push_back(std::make_unique<SlowViewer>(gate));
  Pipeline pipeline(std::move(parts));
  const auto feed = [&](int i) {
    return pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
  };
  feed(0);
  gate.blocked.get_future().wait();
  for (int i = 1; i < 30; ++i) EXPECT_EQ(feed(i).status, TrackingStatus::tracked) << i;
  EXPECT_FALSE(pipeline.map_snapshot().keyframes.empty());
  gate.released.set_value();
  pipeline.finish();
  EXPECT_FALSE(gate.gave_up);
}

TEST(Pipeline, FindsItsPlaceInALoadedMap) {
  test::PointWorld world(find_camera("tum_fr1").value());
  Map map;
  {
    Pipeline pipeline(parts_for(world, 0.3));
    for (int i = 0; i < 60; ++i)
      pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
    map = pipeline.take_map();
  }
  const std::size_t keyframes = map.keyframes().size(), points = map.points().size();
  PipelineParts parts = parts_for(world, 0.3);
  parts.loop_detector = std::make_unique<test::BruteForceDetector>();
  parts.map = std::move(map);
  parts.localise_only = true;
  Pipeline pipeline(std::move(parts));
  for (int i = 0; i < 30; ++i) {
    const double time = 1.51 - i / 30.0;  // backwards, and between the frames that made the map
    const FrameResult result = pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i, test::path_pose(time)));
    EXPECT_EQ(result.status, TrackingStatus::tracked) << i;
    EXPECT_EQ(result.method, i == 0 ? TrackingMethod::relocalised : result.method);
    ASSERT_TRUE(result.T_world_camera);
    EXPECT_LT((result.T_world_camera->translation() - test::path_pose(time).translation()).norm(), 0.006) << i;
    EXPECT_FALSE(result.is_keyframe);
  }
  EXPECT_EQ(pipeline.map().keyframes().size(), keyframes);
  EXPECT_EQ(pipeline.map().points().size(), points);
}

/// Keyframes of the earlier run are adjusted as well.
TEST(Pipeline, SearchesTheWholeMapAgainAfterThreadsAlsoOneThatWasLoaded) {
  test::PointWorld world(find_camera("tum_fr1").value());
  Map map;
  for (const double begin : {0.0, 100.0}) {
    SCOPED_TRACE(begin);
    PipelineParts parts = parts_for(world, 0.3);
    parts.run.mode = RunMode::threaded;
    parts.mapping.final_rounds = 1;
    parts.loop_detector = std::make_unique<test::BruteForceDetector>();
    const std::vector<KeyFrameId> earlier = map.keyframes_by_age();
    parts.map = std::exchange(map, {});
    Pipeline pipeline(std::move(parts));
    for (int i = 0; i < 60; ++i) {
      const FrameResult result =
          pipeline.feed(world.frame(static_cast<std::uint64_t>(i), begin + i / 30.0, test::path_pose(i / 30.0)));
      EXPECT_EQ(result.method == TrackingMethod::relocalised, i == 0 && !earlier.empty()) << i;
    }
    pipeline.finish();
    const LoopRecord record = pipeline.loop_record();
    ASSERT_EQ(record.adjustments.size(), 2U);
    for (const FullAdjustmentSummary& adjustment : record.adjustments) EXPECT_TRUE(adjustment.applied);
    const Map& found = pipeline.map();
    for (const KeyFrameId id : earlier) EXPECT_NE(found.find_keyframe(id), nullptr);
    EXPECT_EQ(static_cast<std::size_t>(record.adjustments.back().keyframes), found.keyframes().size());
    const Trajectory trajectory = pipeline.trajectory();
    ASSERT_EQ(trajectory.size(), 60U);
    for (const TimedPose& pose : trajectory)
      EXPECT_LT((pose.T_world_camera.translation() - test::path_pose(pose.timestamp - begin).translation()).norm(),
                0.01)
          << pose.timestamp;
    map = pipeline.take_map();
  }
}

TEST(Pipeline, WaitsForAFrameWithDepth) {
  test::PointWorld world(Camera{});
  Pipeline pipeline(parts_for(world, 0.0));
  SensorFrame blind = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
  blind.depth.release();
  FrameResult result = pipeline.feed(blind);
  EXPECT_EQ(result.status, TrackingStatus::waiting);
  EXPECT_EQ(result.failure, TrackingFailure::no_depth);
  EXPECT_FALSE(result.T_world_camera);
  result = pipeline.feed(world.frame(1, 0.1, Eigen::Isometry3d::Identity(), false));
  EXPECT_EQ(result.failure, TrackingFailure::few_features);
  result = pipeline.feed(world.frame(2, 0.2, Eigen::Isometry3d::Identity()));
  EXPECT_EQ(result.status, TrackingStatus::initialised);
}

TEST(Pipeline, RefusesStampsThatDoNotRise) {
  test::PointWorld world(Camera{});
  Pipeline pipeline(parts_for(world, 0.0));
  pipeline.feed(world.frame(0, 1.0, Eigen::Isometry3d::Identity()));
  EXPECT_THROW(pipeline.feed(world.frame(1, 1.0, Eigen::Isometry3d::Identity())), InputError);
}

TEST(Pipeline, RequiredPartsAreRequired) { EXPECT_THROW(Pipeline(PipelineParts{}), CheckError); }

/// Counts what it is told.
class Counter final : public Observer {
 public:
  struct Counts {
    int frames = 0, keyframes = 0, finished = 0;
  };
  explicit Counter(Counts& counts) : counts_(counts) {}
  void on_frame(const SensorFrame&, const Frame&, const FrameResult&) override { ++counts_.frames; }
  void on_keyframe(KeyFrameId, const ObservedMap&) override { ++counts_.keyframes; }
  void on_finish(const Map&) override { ++counts_.finished; }

 private:
  Counts& counts_;
};

TEST(Pipeline, TellsItsObservers) {
  test::PointWorld world(Camera{});
  PipelineParts parts = parts_for(world, 0.0);
  Counter::Counts counts;
  parts.observers.push_back(std::make_unique<Counter>(counts));
  Pipeline pipeline(std::move(parts));
  int keyframes = 0;
  for (int i = 0; i < 10; ++i)
    keyframes +=
        pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0))).is_keyframe ? 1
                                                                                                                   : 0;
  pipeline.finish();
  EXPECT_EQ(counts.frames, 10);
  EXPECT_EQ(counts.keyframes, keyframes);
  EXPECT_EQ(counts.finished, 1);
}

/// Parts that look at colour see the images before tracking does.
TEST(Pipeline, RefusesAnEmptyColourImageWhateverPartsLookAtIt) {
  test::PointWorld world(Camera{});
  for (const bool has_observer : {false, true}) {
    PipelineParts parts = parts_for(world, 0.0);
    Counter::Counts counts;
    if (has_observer) parts.observers.push_back(std::make_unique<Counter>(counts));
    Pipeline pipeline(std::move(parts));
    SensorFrame frame = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
    frame.colour = cv::Mat();
    try {
      pipeline.feed(frame);
      ADD_FAILURE() << has_observer;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("the colour image is 0x0"), std::string::npos) << error.what();
    }
    EXPECT_EQ(counts.frames, 0);
    EXPECT_EQ(pipeline.feed(world.frame(1, 0.1, Eigen::Isometry3d::Identity())).status, TrackingStatus::initialised);
  }
}

}  // namespace
}  // namespace holdfast
