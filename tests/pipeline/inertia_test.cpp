// SPDX-License-Identifier: BSD-3-Clause
// Inertial measurements in adjustments of the whole map, in a whole run.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/run/results.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/settings/flann.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/settings/schur.hpp"
#include "holdfast/simulation/imu_sensor.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

/// Of a camera with a bmi055 whose measurements tracking uses or not.
PipelineBuilder builder(const Camera& camera, Sensor sensor, int features, bool inertia = true) {
  TrackingSettings tracking;
  tracking.inertia = inertia;
  PipelineBuilder result;
  result.camera(camera)
      .sensor(sensor)
      .imu(*find_imu("bmi055"))
      .features(OrbSettings{.count = features})
      .optimizer(SchurSettings{})
      .tracking(tracking);
  return result;
}

/// A camera among objects that rest. Its lens is covered for the first 0.2 s, and later for 0.8 s.
class InertiaTest : public ::testing::Test {
 protected:
  struct Run {
    Trajectory trajectory, keyframes;
    std::optional<MapInertia> inertia;
    std::size_t placed_by_inertia;
  };

  InertiaTest() {
    simulation::ImuSensor sensor(simulator_.path(), imu_, 1);
    const double begin = simulator_.frame(0).timestamp;
    for (std::uint64_t i = 0; i < simulator_.frame_count(); ++i) {
      SensorFrame frame = simulator_.frame(i);
      frame.imu = sensor.take(frame.timestamp);
      const double time = frame.timestamp;
      if (time < begin + 0.2 || (time > 3.5 && time < 4.3)) frame.colour.setTo(0), frame.depth.setTo(0);
      truth_.push_back({frame.timestamp, *frame.truth->T_world_camera});
      frame.truth.reset();
      frames_.push_back(std::move(frame));
    }
  }
  Run run(bool is_inertial) const {
    MappingSettings mapping;
    mapping.inertia = is_inertial;
    Pipeline pipeline = builder(simulator_.camera(), Sensor::rgbd, 500).mapping(mapping).build();
    for (const SensorFrame& frame : frames_) pipeline.feed(frame);
    pipeline.finish();
    return {pipeline.trajectory(), pipeline.keyframe_trajectory(), pipeline.map().inertia(),
            pipeline.loss_record().placed_by_inertia};
  }
  Statistics error(const Trajectory& trajectory) const { return evaluate(truth_, trajectory, {}).absolute_error; }

  const ImuCalibration imu_ = *find_imu("bmi055");
  simulation::Simulator simulator_{
      simulation::read_scene({}, {"camera.path=xyz", "seed=3", "frame_rate=20", "duration=6"}),
      *find_camera("tum_fr3")};
  std::vector<SensorFrame> frames_;
  Trajectory truth_;
};

bool is_same(const Trajectory& a, const Trajectory& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TimedPose& x, const TimedPose& y) {
    return x.timestamp == y.timestamp && x.T_world_camera.matrix() == y.T_world_camera.matrix();
  });
}

TEST_F(InertiaTest, AMapWithMotionsIsMoreAccurateAndTheSameInEachRun) {
  const Run linked = run(true), repeated = run(true), visual = run(false);
  ASSERT_EQ(linked.trajectory.size(), frames_.size()) << "one trajectory";
  EXPECT_EQ(linked.placed_by_inertia, 4U) << "before there was a map";
  EXPECT_EQ(visual.placed_by_inertia, 0U);
  EXPECT_TRUE(is_same(linked.trajectory, repeated.trajectory));
  EXPECT_TRUE(is_same(linked.keyframes, repeated.keyframes));
  EXPECT_LT(error(linked.trajectory).rmse, 0.0025);
  EXPECT_LT(error(linked.trajectory).rmse, 0.95 * error(visual.trajectory).rmse);
  EXPECT_LT(error(linked.keyframes).rmse, 0.95 * error(visual.keyframes).rmse);
  EvaluationOptions with_scale;
  with_scale.alignment = AlignmentKind::sim3;
  EXPECT_NEAR(evaluate(truth_, linked.trajectory, with_scale).alignment.scale, 1.0, 0.005);
  ASSERT_TRUE(linked.inertia);
  const Eigen::Vector3d down(0.0, 0.0, -1.0), gravity = linked.inertia->gravity.normalized();
  const auto in_camera = [](const Trajectory& poses, const Eigen::Vector3d& direction) {
    return poses.front().T_world_camera.linear().transpose() * direction;
  };
  EXPECT_GT(in_camera(linked.trajectory, gravity).dot(in_camera(truth_, down)), std::cos(0.03));
}

/// An optimizer that, in its first problem after `waits` was set, waits for somebody else.
class WaitingOptimizer final : public Optimizer {
 public:
  struct Meeting {
    std::atomic<bool> waits = false;
    std::promise<void> began, go_on;
    bool gave_up = false;
  };
  explicit WaitingOptimizer(Meeting& meeting) : meeting_(meeting) {}
  bool supports(FactorKind factor) const override { return schur_->supports(factor); }
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    if (meeting_.waits.exchange(false)) {
      meeting_.began.set_value();
      meeting_.gave_up = meeting_.go_on.get_future().wait_for(std::chrono::minutes(1)) != std::future_status::ready;
    }
    return schur_->optimize_bundle(problem, stop);
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override { return schur_->optimize_pose_graph(problem); }

 private:
  Meeting& meeting_;
  std::unique_ptr<Optimizer> schur_ = [] {
    Registry registry;
    register_builtin_plugins(registry);
    return registry.create<Optimizer>("schur", {}, {});
  }();
};

TEST_F(InertiaTest, TheMapCanBeSeenWhileTheRunEnds) {
  WaitingOptimizer::Meeting meeting;
  Pipeline pipeline = builder(simulator_.camera(), Sensor::rgbd, 500)
                          .optimizer({std::make_unique<WaitingOptimizer>(meeting), "waiting"})
                          .build();
  for (const SensorFrame& frame : frames_) pipeline.feed(frame);
  const MapSnapshot before = pipeline.map_snapshot();
  MapSnapshot during;
  meeting.waits = true;
  std::thread watcher([&] {
    meeting.began.get_future().wait();
    during = pipeline.map_snapshot();
    meeting.go_on.set_value();
  });
  pipeline.finish();
  watcher.join();
  EXPECT_FALSE(meeting.gave_up) << "the adjustment at the end holds the lock of the map";
  ASSERT_EQ(during.keyframes.size(), before.keyframes.size());
  const MapSnapshot after = pipeline.map_snapshot();
  ASSERT_EQ(after.keyframes.size(), before.keyframes.size());
  const auto last_pose = [](const MapSnapshot& map) { return map.keyframes.back().T_world_camera.matrix(); };
  EXPECT_EQ(last_pose(during), last_pose(before)) << "not a part of the result";
  EXPECT_NE(last_pose(after), last_pose(before));
}

/// In a map without estimates, inertia starts after two seconds at the earliest.
TEST_F(InertiaTest, LocalisesWithTheEstimatesOfItsMap) {
  const std::string file = testing::TempDir() + "inertia_test.hfm";
  {
    Pipeline pipeline = builder(simulator_.camera(), Sensor::rgbd, 500).build();
    for (const SensorFrame& frame : frames_) pipeline.feed(frame);
    pipeline.finish();
    write_map(file, pipeline.map());
  }
  std::size_t verticals = 0, motions = 0;
  const Map map = read_map(file);
  map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
    verticals += keyframe.vertical ? 1 : 0, motions += keyframe.motion ? 1 : 0;
    if (!keyframe.vertical) return;
    const Eigen::Vector3d down = keyframe.frame.T_camera_world.linear() * map.inertia()->gravity.normalized();
    EXPECT_LT((down - *keyframe.vertical).norm(), 0.03);
  });
  EXPECT_GE(motions, map.keyframes().size() - 1);
  EXPECT_GE(verticals, map.keyframes().size() / 4) << "those after the start";
  for (const bool knows : {true, false}) {
    Map given = read_map(file);
    if (!knows) given.set_inertia(std::nullopt);
    Pipeline pipeline = builder(simulator_.camera(), Sensor::rgbd, 500)
                            .loop_detector(FlannSettings{})
                            .localise_in(std::move(given))
                            .build();
    std::size_t bridged = 0;
    for (SensorFrame frame : frames_) {
      if (frame.timestamp > 1.5) break;
      if (frame.timestamp > 1.0 && frame.timestamp < 1.35) {
        frame.colour = cv::Mat::zeros(frame.colour.size(), frame.colour.type());
        frame.depth = cv::Mat::zeros(frame.depth.size(), frame.depth.type());
      }
      if (pipeline.feed(frame).status == TrackingStatus::inertial) ++bridged;
    }
    pipeline.finish();
    EXPECT_EQ(bridged > 3, knows) << bridged;
    if (knows) {
      EXPECT_LT(error(pipeline.trajectory()).maximum, 0.02);
      EXPECT_EQ(pipeline.map().inertia()->gravity, map.inertia()->gravity) << "of the map";
    }
  }
}

/// Three frames in two seconds. The lens is covered for two of them.
TEST(SlowCameraWithInertia, KeepsItsPoseWithoutAView) {
  const ImuCalibration imu = *find_imu("bmi055");
  simulation::Simulator simulator(
      simulation::read_scene({}, {"camera.path=xyz", "seed=3", "frame_rate=1.5", "duration=20"}),
      *find_camera("tum_fr3"));
  const auto is_covered = [](double time) { return time > 13.5 && time < 14.9; };
  const auto run = [&](bool inertia) {
    simulation::ImuSensor sensor(simulator.path(), imu, 1);
    Pipeline pipeline = builder(simulator.camera(), Sensor::rgbd, 500, inertia).build();
    Trajectory truth;
    for (std::uint64_t i = 0; i < simulator.frame_count(); ++i) {
      SensorFrame frame = simulator.frame(i);
      frame.imu = sensor.take(frame.timestamp);
      if (is_covered(frame.timestamp)) frame.colour.setTo(0), frame.depth.setTo(0);
      truth.push_back({frame.timestamp, *frame.truth->T_world_camera});
      frame.truth.reset();
      pipeline.feed(frame);
    }
    pipeline.finish();
    return evaluate(truth, pipeline.trajectory(), {});
  };
  const auto inertial = run(true), visual = run(false);
  EXPECT_EQ(inertial.poses.size(), simulator.frame_count()) << "all of them";
  EXPECT_LT(visual.poses.size(), simulator.frame_count());
  EXPECT_LT(inertial.absolute_error.maximum, 0.05);
}

/// A simulated camera with an IMU, without depth.
class OneCameraSource final : public FrameSource {
 public:
  OneCameraSource(int seconds, const std::string& path)
      : simulator_(simulation::read_scene(
                       {}, {"camera.path=" + path, "seed=3", "frame_rate=20", "duration=" + std::to_string(seconds)}),
                   *find_camera("tum_fr3")),
        sensor_(simulator_.path(), *find_imu("bmi055"), 1) {}
  SourceDescription describe() const override {
    SourceDescription description;
    description.name = "one camera";
    description.frame_count = simulator_.frame_count();
    description.camera = simulator_.camera();
    description.has_imu = true;
    return description;
  }
  std::optional<SensorFrame> next() override {
    if (next_ == simulator_.frame_count()) return std::nullopt;
    SensorFrame frame = simulator_.frame(next_++);
    frame.imu = sensor_.take(frame.timestamp);
    truth_.push_back({frame.timestamp, *frame.truth->T_world_camera});
    frame.truth.reset();
    return frame;
  }
  Trajectory truth() const override { return truth_; }

 private:
  simulation::Simulator simulator_;
  simulation::ImuSensor sensor_;
  std::uint64_t next_ = 0;
  Trajectory truth_;
};

/// One camera with an IMU for some seconds.
struct OneCameraWithInertia : ::testing::Test {
  void run(int seconds, const std::string& path = "xyz") {
    auto source = std::make_unique<OneCameraSource>(seconds, path);
    const Camera camera = *source->describe().camera;
    built =
        std::make_unique<BuiltPipeline>(BuiltPipeline{std::move(source), builder(camera, Sensor::mono, 1000).build()});
    Configuration configuration;
    configuration.file = "one_camera.yaml";
    record = holdfast::run(*built, configuration);
    ASSERT_EQ(record.failure, "");
    truth = built->source->truth();
    json = nlohmann::json::parse(run_json(record));
  }
  bool says_that_scale_is_missing() const {
    const Warnings warnings = built->pipeline.warnings();
    return std::any_of(warnings.begin(), warnings.end(), [](const Diagnostic& warning) {
      return warning.to_string().find("the map keeps its own unit") != std::string::npos;
    });
  }

  std::unique_ptr<BuiltPipeline> built;
  RunRecord record;
  nlohmann::json json;
  Trajectory truth;
};

/// Its map has a unit of its own until then.
TEST_F(OneCameraWithInertia, EndsInMetres) {
  ASSERT_NO_FATAL_FAILURE(run(9));
  const Pipeline& pipeline = built->pipeline;
  EXPECT_FALSE(says_that_scale_is_missing());
  ASSERT_TRUE(pipeline.map().inertia());
  EXPECT_EQ(pipeline.map().inertia()->scale, 1.0);
  EvaluationOptions with_scale;
  with_scale.alignment = AlignmentKind::sim3;
  EXPECT_NEAR(evaluate(truth, pipeline.trajectory(), with_scale).alignment.scale, 1.0, 0.01);
  EXPECT_NEAR(evaluate(truth, pipeline.keyframe_trajectory(), with_scale).alignment.scale, 1.0, 0.01);
  const double error = evaluate(truth, pipeline.trajectory(), {}).absolute_error.rmse;
  EXPECT_LT(error, 0.006) << "frames between keyframes as well";
  EXPECT_EQ(json["is_metric"], true);
  EXPECT_EQ(json["evaluation"]["alignment"]["kind"], "se3");
  EXPECT_NEAR(json["evaluation"]["ate_m"]["rmse"].get<double>(), error, 1e-6);
}

/// Five seconds on this path do not determine the scale, so that tracking is visual; all of them do.
TEST_F(OneCameraWithInertia, EndsInMetresWhereTrackingFoundNoScale) {
  ASSERT_NO_FATAL_FAILURE(run(12, "halfsphere"));
  EXPECT_FALSE(says_that_scale_is_missing());
  EvaluationOptions with_scale;
  with_scale.alignment = AlignmentKind::sim3;
  EXPECT_NEAR(evaluate(truth, built->pipeline.trajectory(), with_scale).alignment.scale, 1.0, 0.01);
}

TEST_F(OneCameraWithInertia, WithoutAStartItsOwnUnitIsNamed) {
  ASSERT_NO_FATAL_FAILURE(run(3));
  EXPECT_TRUE(says_that_scale_is_missing());
  EXPECT_EQ(json["is_metric"], false);
  EXPECT_EQ(json["evaluation"]["alignment"]["kind"], "sim3");
}

}  // namespace
}  // namespace holdfast
