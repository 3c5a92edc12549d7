// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/rolling_shutter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "holdfast/core/scale_pyramid.hpp"
#include "holdfast/tracking/no_depth.hpp"
#include "holdfast/tracking/tracker.hpp"
#include "holdfast/tracking/view_motion.hpp"
#include "support/brute_force_detector.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

constexpr double interval = 1.0 / 30.0, readout = 0.03;

FrameMotion motion_of(const Eigen::Vector3d& velocity, const Eigen::Vector3d& rotation) {
  FrameMotion motion{geometry::Vector6d::Zero(), interval};
  motion.tangent << interval * velocity, interval * rotation;
  return motion;
}

/// Points in front of a camera whose rows are exposed one after another.
class RollingShutterTest : public testing::Test {
 protected:
  RollingShutterTest() : camera_(std::make_shared<const Camera>(find_camera("tum_fr3").value())) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> column(0, camera_->width), row(0, camera_->height), depth(0.8, 5.0);
    for (int i = 0; i < 500; ++i) {
      world_.push_back(camera_->back_project(column(random), row(random), depth(random)));
    }
  }

  /// The pixel that shows a point of the world at a moment after the exposure of the middle row.
  Eigen::Vector3d seen(const Eigen::Isometry3d& T_camera_world, const FrameMotion& motion, double seconds,
                       const Eigen::Vector3d& point) const {
    return motion.during(seconds) * (T_camera_world * point);
  }

  /// A frame as the camera takes it: every point where its own row shows it.
  Frame take(const Eigen::Isometry3d& T_camera_world, const FrameMotion& motion) const {
    Frame frame;
    frame.camera = camera_;
    frame.pyramid = std::make_shared<const ScalePyramid>(8, 1.2);
    frame.T_camera_world = T_camera_world;
    frame.features.resize(world_.size());
    for (std::size_t i = 0; i < world_.size(); ++i) {
      double seconds = 0.0;
      Eigen::Vector3d point;
      Eigen::Vector2d pixel;
      for (int step = 0; step < 20; ++step) {
        point = seen(T_camera_world, motion, seconds, world_[i]);
        pixel = camera_->project(point);
        seconds = (pixel.y() / camera_->height - 0.5) * readout;
      }
      frame.features.x[i] = static_cast<float>(pixel.x());
      frame.features.y[i] = static_cast<float>(pixel.y());
      frame.features.octave[i] = 0;
      frame.x.push_back(static_cast<float>(pixel.x()));
      frame.y.push_back(static_cast<float>(pixel.y()));
      frame.depth.push_back(static_cast<float>(point.z()));
      frame.right_x.push_back(static_cast<float>(camera_->right_x(pixel.x(), point.z())));
    }
    frame.map_points.assign(world_.size(), MapPointId());
    frame.static_probability.assign(world_.size(), 1.0F);
    return frame;
  }

  double largest_error(const Frame& frame) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < world_.size(); ++i) {
      const Eigen::Vector2d pixel = camera_->project(frame.T_camera_world * world_[i]);
      largest = std::max(largest, (pixel - Eigen::Vector2d(frame.x[i], frame.y[i])).norm());
    }
    return largest;
  }

  std::shared_ptr<const Camera> camera_;
  std::vector<Eigen::Vector3d> world_;
};

TEST_F(RollingShutterTest, TakesFeaturesToTheExposureOfTheMiddleRow) {
  const FrameMotion motion = motion_of({0.3, -0.2, 0.1}, {0.5, 1.5, -0.8});
  Frame frame = take(Eigen::Isometry3d::Identity(), motion);
  EXPECT_GT(largest_error(frame), 10.0);
  RollingShutter(RollingShutterMode::fixed, readout).correct(motion, Map(), frame);
  EXPECT_LT(largest_error(frame), 0.02);
  for (std::size_t i = 0; i < world_.size(); ++i) {
    EXPECT_NEAR(frame.depth[i], world_[i].z(), 1e-3);
    EXPECT_NEAR(frame.right_x[i], camera_->right_x(frame.x[i], frame.depth[i]), 1e-3);
  }
}

TEST_F(RollingShutterTest, FeaturesWithoutDepthAreCorrectedForRotation) {
  const FrameMotion motion = motion_of(Eigen::Vector3d::Zero(), {0.5, 1.5, -0.8});
  Frame frame = take(Eigen::Isometry3d::Identity(), motion);
  frame.depth.assign(world_.size(), 0.0F);
  RollingShutter(RollingShutterMode::fixed, readout).correct(motion, Map(), frame);
  EXPECT_LT(largest_error(frame), 0.02);
  for (const float depth : frame.depth) EXPECT_EQ(depth, 0.0F);
}

TEST_F(RollingShutterTest, WithoutAMapTheRotationIsThatOfMatchedFeatures) {
  const FrameMotion motion = motion_of({0.05, 0.0, 0.0}, {0.5, 1.5, -0.8});
  Frame previous = take(Eigen::Isometry3d::Identity(), motion), frame = take(motion.during(interval), motion);
  std::mt19937_64 random(2);
  for (Frame* each : {&previous, &frame}) each->depth.assign(world_.size(), 0.0F), each->features.descriptors.clear();
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const Descriptor256 descriptor{{random(), random(), random(), random()}};
    previous.features.descriptors.push_back(descriptor);
    frame.features.descriptors.push_back(descriptor);
  }
  const auto rotation = [&](const Frame& before) { return rotation_since(before, frame, nearest_matcher(), 50.0F); };
  EXPECT_FALSE(rotation(previous)) << "no time has passed";
  frame.timestamp = interval;
  EXPECT_FALSE(rotation(Frame())) << "there is no previous frame";
  const std::optional<FrameMotion> found = rotation(previous);
  ASSERT_TRUE(found);
  EXPECT_GT(largest_error(frame), 10.0);
  RollingShutter(RollingShutterMode::fixed, readout).correct(*found, Map(), frame);
  EXPECT_LT(largest_error(frame), 1.0);
}

/// "Extracts" the features of a frame that the test has taken, with the same random descriptors in every frame of a
/// seed.
class TakenFeatures final : public FeatureExtractor {
 public:
  void extract(const cv::Mat&, const cv::Mat&, Features& out) override {
    out = taken;
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < out.size(); ++i)
      out.descriptors.of_256_bits()[i] = {{random(), random(), random(), random()}};
  }
  const ScalePyramid& pyramid() const override { return pyramid_; }

  Features taken;
  std::uint64_t seed = 2;

 private:
  ScalePyramid pyramid_;
};

/// A camera that turns without moving, so that a map of one camera does not begin: its rows are corrected already.
TEST_F(RollingShutterTest, OneCameraThatWaitsForItsMapCorrectsRows) {
  Camera camera = *camera_;
  camera.readout = readout;
  TakenFeatures extractor;
  NoDepth depth;
  test::PoseOptimizer optimizer;
  test::BruteForceDetector detector;
  Map map;
  map.set_sensor(Sensor::mono);
  MovingWorld moving_world({.camera = camera}, map);
  TrackingSettings settings;
  settings.rolling_shutter = RollingShutterMode::fixed;
  Tracker tracker(settings, {camera, extractor, depth, optimizer, detector, moving_world, map});
  const MapAccess access(map);
  const FrameMotion motion = motion_of(Eigen::Vector3d::Zero(), {0.5, 1.5, -0.8});
  SensorFrame sensor_frame;
  sensor_frame.colour = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  FrameResult result;
  // The error of the features of the next frame, `intervals` after the last one [px].
  const auto error_after = [&](double intervals) {
    sensor_frame.timestamp += intervals * interval;
    const Eigen::Isometry3d T_camera_world = motion.during(sensor_frame.timestamp);
    extractor.taken = take(T_camera_world, motion).features;
    moving_world.next_frame(sensor_frame.timestamp);
    result = {};
    tracker.begin(sensor_frame, result);
    tracker.locate(access, sensor_frame, result);
    ++sensor_frame.index;
    EXPECT_EQ(result.status, TrackingStatus::waiting);
    Frame frame = tracker.frame();
    frame.T_camera_world = T_camera_world;
    return largest_error(frame);
  };
  EXPECT_GT(error_after(0.0), 10.0) << "a first frame has no motion";
  EXPECT_LT(error_after(1.0), 4.0) << "compared with displaced rows";
  EXPECT_LT(error_after(1.0), 1.0);
  EXPECT_EQ(result.failure, TrackingFailure::little_parallax);
  EXPECT_GT(error_after(7.0), 10.0) << "the mean motion over a longer time does not tell that at the exposure";
  extractor.seed = 3;
  EXPECT_GT(error_after(1.0), 10.0);
  EXPECT_EQ(result.failure, TrackingFailure::few_matches) << "nothing tells how the camera has turned";
}

TEST_F(RollingShutterTest, FeaturesWithoutDepthHaveThatOfTheirMapPoints) {
  const FrameMotion motion = motion_of({0.6, 0.0, 0.0}, Eigen::Vector3d::Zero());
  Frame frame = take(Eigen::Isometry3d::Identity(), motion);
  Map map;
  for (std::size_t i = 0; i < world_.size(); ++i) frame.map_points[i] = map.add_point(world_[i], 0);
  frame.depth.assign(world_.size(), 0.0F);
  RollingShutter(RollingShutterMode::fixed, readout).correct(motion, map, frame);
  EXPECT_LT(largest_error(frame), 0.02);
}

/// A camera that turns faster and faster: the step between two exposures has the rate of half an interval ago.
TEST_F(RollingShutterTest, TheRotationAtTheEndOfAStepFollowsItsChange) {
  const Eigen::Vector3d rate(0.5, 1.5, -0.8), change = Eigen::Vector3d(6.0, -20.0, 10.0);  // rad/s, rad/s^2
  const auto step_before = [&](double seconds) { return motion_of({0.3, 0.0, 0.0}, rate - seconds * change); };
  const FrameMotion step = step_before(interval / 2);
  const FrameMotion now = step.at_end(step_before(1.5 * interval).tangent);
  const FrameMotion expected = step_before(0.2 * interval);
  EXPECT_NEAR((now.tangent - expected.tangent).norm(), 0.0, 1e-12);
  const auto error = [&](const FrameMotion& motion) {
    Frame frame = take(Eigen::Isometry3d::Identity(), motion_of({0.3, 0.0, 0.0}, rate));
    RollingShutter(RollingShutterMode::fixed, readout).correct(motion, Map(), frame);
    return largest_error(frame);
  };
  EXPECT_GT(error(step), 2.0);
  EXPECT_LT(error(now), 0.45 * error(step));
}

TEST_F(RollingShutterTest, IsOffWithoutReadoutTime) {
  EXPECT_FALSE(RollingShutter(RollingShutterMode::fixed, 0.0).is_active());
  EXPECT_FALSE(RollingShutter(RollingShutterMode::off, readout).is_active());
  EXPECT_TRUE(RollingShutter(RollingShutterMode::fixed, readout).is_active());
}

/// Estimates the readout time while a camera swings, beginning with a wrong one.
double estimate(const std::function<Frame(const Eigen::Isometry3d&, const FrameMotion&)>& take, const Map& map,
                const std::vector<MapPointId>& points, RollingShutter shutter) {
  for (int i = 0; i < 60; ++i) {
    const double swing = std::sin(0.3 * i);
    const FrameMotion motion = motion_of({0.1 * swing, 0.2, 0.0}, {0.4, 1.2 * swing, 0.3 * swing});
    Frame frame = take(Eigen::Isometry3d::Identity(), motion);
    frame.map_points = points;
    if (shutter.is_active()) shutter.correct(motion, map, frame);
    shutter.learn(motion, map, frame);
  }
  return shutter.readout();
}

TEST_F(RollingShutterTest, FindsTheReadoutTime) {
  Map map;
  std::vector<MapPointId> points;
  for (const Eigen::Vector3d& point : world_) points.push_back(map.add_point(point, 0));
  const auto picture = [this](const Eigen::Isometry3d& pose, const FrameMotion& motion) { return take(pose, motion); };
  EXPECT_NEAR(estimate(picture, map, points, {RollingShutterMode::estimated, 0.0}), readout, 1e-4);
  EXPECT_NEAR(estimate(picture, map, points, {RollingShutterMode::estimated, 0.05}), readout, 1e-3);
  EXPECT_EQ(estimate(picture, map, points, {RollingShutterMode::fixed, 0.01}), 0.01);
}

}  // namespace
}  // namespace holdfast
