// SPDX-License-Identifier: BSD-3-Clause
// Inertial measurements in adjustments of the whole map, in a whole run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
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

/// A camera among objects that rest. Its lens is covered for 0.8 s.
class InertiaTest : public ::testing::Test {
 protected:
  struct Run {
    Trajectory trajectory, keyframes;
    std::optional<MapInertia> inertia;
  };

  InertiaTest() {
    simulation::ImuSensor sensor(simulator_.path(), imu_, 1);
    for (std::uint64_t i = 0; i < simulator_.frame_count(); ++i) {
      SensorFrame frame = simulator_.frame(i);
      frame.imu = sensor.take(frame.timestamp);
      if (frame.timestamp > 3.5 && frame.timestamp < 4.3) frame.colour.setTo(0), frame.depth.setTo(0);
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
    return {pipeline.trajectory(), pipeline.keyframe_trajectory(), pipeline.map().inertia()};
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

/// One camera with an IMU for some seconds.
struct OneCameraWithInertia : ::testing::Test {
  Pipeline run(int seconds, const std::string& path = "xyz") {
    const ImuCalibration imu = *find_imu("bmi055");
    simulation::Simulator simulator(simulation::read_scene({}, {"camera.path=" + path, "seed=3", "frame_rate=20",
                                                                "duration=" + std::to_string(seconds)}),
                                    *find_camera("tum_fr3"));
    simulation::ImuSensor sensor(simulator.path(), imu, 1);
    Pipeline pipeline = builder(simulator.camera(), Sensor::mono, 1000).build();
    for (std::uint64_t i = 0; i < simulator.frame_count(); ++i) {
      SensorFrame frame = simulator.frame(i);
      frame.imu = sensor.take(frame.timestamp);
      truth.push_back({frame.timestamp, *frame.truth->T_world_camera});
      pipeline.feed(frame);
    }
    pipeline.finish();
    return pipeline;
  }
  static bool says_that_scale_is_missing(const Pipeline& pipeline) {
    const Warnings warnings = pipeline.warnings();
    return std::any_of(warnings.begin(), warnings.end(), [](const Diagnostic& warning) {
      return warning.to_string().find("the map keeps its own unit") != std::string::npos;
    });
  }

  Trajectory truth;
};

/// Its map has a unit of its own until then.
TEST_F(OneCameraWithInertia, EndsInMetres) {
  const Pipeline pipeline = run(9);
  EXPECT_FALSE(says_that_scale_is_missing(pipeline));
  ASSERT_TRUE(pipeline.map().inertia());
  EXPECT_EQ(pipeline.map().inertia()->scale, 1.0);
  EvaluationOptions with_scale;
  with_scale.alignment = AlignmentKind::sim3;
  EXPECT_NEAR(evaluate(truth, pipeline.trajectory(), with_scale).alignment.scale, 1.0, 0.02);
  EXPECT_NEAR(evaluate(truth, pipeline.keyframe_trajectory(), with_scale).alignment.scale, 1.0, 0.02);
  EXPECT_LT(evaluate(truth, pipeline.trajectory(), {}).absolute_error.rmse, 0.006)
      << "frames between keyframes as well";
}

/// Five seconds on this path do not determine the scale, so that tracking is visual; all of them do.
TEST_F(OneCameraWithInertia, EndsInMetresWhereTrackingFoundNoScale) {
  const Pipeline pipeline = run(12, "halfsphere");
  EXPECT_FALSE(says_that_scale_is_missing(pipeline));
  EvaluationOptions with_scale;
  with_scale.alignment = AlignmentKind::sim3;
  EXPECT_NEAR(evaluate(truth, pipeline.trajectory(), with_scale).alignment.scale, 1.0, 0.01);
}

TEST_F(OneCameraWithInertia, WithoutAStartItsOwnUnitIsNamed) { EXPECT_TRUE(says_that_scale_is_missing(run(3))); }

}  // namespace
}  // namespace holdfast
