// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/metric_scale.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_schur(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr double metres_per_unit = 2.5;

/// One camera that swings with `amplitude` [m] along three axes and turns, with poses in a unit of its own that err by
/// 0.5 mm and 0.3 mrad, and a bmi055 in its frame. One keyframe, to which all frames are relative.
class MetricScaleTest : public testing::Test {
 protected:
  static constexpr double frame_interval = 0.04, sample_interval = 0.005;

  static Eigen::Isometry3d pose_at(double time, double amplitude) {
    Eigen::Isometry3d T_world_camera(Eigen::AngleAxisd(0.2 * std::sin(1.3 * time), Eigen::Vector3d::UnitY()));
    T_world_camera.translation() =
        amplitude * Eigen::Vector3d(std::sin(2.0 * time), std::sin(1.4 * time + 1.0), std::sin(1.7 * time + 2.0));
    return T_world_camera;
  }
  static Eigen::Vector3d normal(Random& random, double deviation) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return deviation * Eigen::Vector3d(x, y, z);
  }
  /// The acceleration by differences of the path.
  static ImuSample exact(double time, double amplitude) {
    constexpr double h = 1e-3;
    const Eigen::Isometry3d a = pose_at(time - h, amplitude), b = pose_at(time, amplitude),
                            c = pose_at(time + h, amplitude);
    const Eigen::Vector3d acceleration = (a.translation() - 2.0 * b.translation() + c.translation()) / (h * h);
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.linear().transpose() * c.linear()));
    return {time, turn.angle() * turn.axis() / (2.0 * h), b.linear().transpose() * (acceleration - gravity)};
  }
  /// Moves for `duration` [s]. `drift`: of the unit, in the middle, where measurements are missing for a moment.
  void move(double amplitude, double duration, std::uint64_t seed, double drift = 0.0) {
    Random random(seed);
    const double root_rate = 1.0 / std::sqrt(sample_interval);
    const ImuNoise& noise = imu.noise;
    std::vector<ImuSample> samples;
    for (int k = -1; k * sample_interval < duration + 0.01; ++k) {
      ImuSample sample = exact(k * sample_interval, amplitude);
      sample.angular_velocity +=
          Eigen::Vector3d(0.01, -0.005, 0.008) + normal(random, noise.gyroscope_noise_density * root_rate);
      sample.acceleration +=
          Eigen::Vector3d(0.08, -0.05, 0.1) + normal(random, noise.accelerometer_noise_density * root_rate);
      if (drift == 0.0 || std::abs(k * sample_interval - 0.5 * duration) > 0.1) samples.push_back(sample);
    }
    SensorFrame measured;
    measured.imu = samples;
    inertia.emplace(imu);
    if (has_measurements) inertia->add(measured);
    history = FrameHistory();
    for (int i = 0; i * frame_interval < duration; ++i) {
      Frame frame;
      frame.timestamp = frame_interval * i;
      Eigen::Isometry3d T_world_camera = pose_at(frame.timestamp, amplitude);
      T_world_camera.translation() += normal(random, 0.0005);
      T_world_camera.translation() /= metres_per_unit * (frame.timestamp > 0.5 * duration ? 1.0 + drift : 1.0);
      const Eigen::Vector3d turn = normal(random, 0.0003);
      T_world_camera.linear() = T_world_camera.linear() * geometry::exp_so3(turn).toRotationMatrix();
      frame.T_camera_world = T_world_camera.inverse();
      history.add(frame, reference, map);
    }
  }
  static Frame keyframe() {
    Frame frame;
    frame.timestamp = -1.0;
    frame.x.resize(2), frame.map_points.resize(2);
    frame.camera = std::make_shared<Camera>(find_camera("tum_fr3").value());
    return frame;
  }
  std::optional<MapInertia> estimate(const std::optional<MapInertia>& tracked = std::nullopt) {
    return estimate_metres(path_of(history, map, *inertia), {}, *inertia, tracked, *optimizer, stop);
  }

  static inline const Eigen::Vector3d gravity{0.0, standard_gravity, 0.0};
  const ImuCalibration imu = *find_imu("bmi055");
  bool has_measurements = true;
  Map map;
  KeyFrameId reference = map.add_keyframe(keyframe());
  FrameHistory history;
  std::atomic<bool> stop = false;
  std::optional<InertialHistory> inertia;
  std::unique_ptr<Optimizer> optimizer = [] {
    Registry registry;
    holdfast_register_plugin_schur(registry);
    return registry.create<Optimizer>("schur", {}, {});
  }();
};

TEST_F(MetricScaleTest, FindsTheUnitThatTrackingDidNotFind) {
  move(0.2, 10.0, 1);
  const std::optional<MapInertia> found = estimate();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale / metres_per_unit, 1.0, 0.01);
  EXPECT_GT(found->gravity.normalized().dot(gravity.normalized()), std::cos(0.01));
  EXPECT_NEAR(found->gravity.norm(), standard_gravity, 1e-6);
}

TEST_F(MetricScaleTest, CorrectsTheUnitThatTrackingFound) {
  move(0.2, 10.0, 1);
  const double right = estimate()->scale;
  MapInertia tracked = *estimate();
  tracked.scale *= 1.05;
  const std::optional<MapInertia> corrected = estimate(tracked);
  ASSERT_TRUE(corrected);
  EXPECT_NEAR(corrected->scale / right, 1.0, 0.002);
}

/// The stated deviation of a single estimate must be that of the errors of many.
TEST_F(MetricScaleTest, StatesItsDeviation) {
  double squares = 0.0;
  constexpr int runs = 12;
  for (int i = 0; i < runs; ++i) {
    move(0.2, 8.0, 10 + static_cast<std::uint64_t>(i));
    const auto scale = estimate_scale(path_of(history, map, *inertia), {}, *inertia, *estimate(), *optimizer, stop);
    ASSERT_TRUE(scale);
    squares += std::pow(std::log(scale->scale / metres_per_unit) / scale->deviation, 2);
  }
  EXPECT_GT(squares / runs, 0.3);
  EXPECT_LT(squares / runs, 2.2);
}

TEST_F(MetricScaleTest, ACameraThatHardlyMovesHasNoMetres) {
  move(0.004, 10.0, 1);
  EXPECT_FALSE(estimate());
  move(0.015, 10.0, 1);  // some motion, by which the scale is uncertain by a few percent
  EXPECT_FALSE(estimate());
  move(0.0, 10.0, 1);
  EXPECT_FALSE(estimate());
}

TEST_F(MetricScaleTest, NeitherFourSecondsNorMissingMeasurementsDo) {
  move(0.2, 4.0, 1);
  EXPECT_FALSE(estimate());
  has_measurements = false;
  move(0.2, 10.0, 1);
  EXPECT_FALSE(estimate());
}

/// Each half determines its scale to a fraction of a percent.
TEST_F(MetricScaleTest, HalvesThatContradictEachOtherHaveNoCommonMetres) {
  move(0.2, 20.0, 1, 0.1);
  EXPECT_FALSE(estimate());
  move(0.2, 20.0, 1, 1e-9);
  EXPECT_TRUE(estimate()) << "the gap alone does no harm";
}

TEST_F(MetricScaleTest, StopsWhenAsked) {
  move(0.2, 10.0, 1);
  stop = true;
  EXPECT_FALSE(estimate());
}

}  // namespace
}  // namespace holdfast
