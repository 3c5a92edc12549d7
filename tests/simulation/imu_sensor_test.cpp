// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/imu_sensor.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/imu_plausibility.hpp"
#include "holdfast/geometry/preintegration.hpp"
#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {
namespace {

CameraPath path_of(PathKind kind) { return CameraPath(kind, make_stage(RoomKind::office), 3); }

ImuCalibration calibration() {
  ImuCalibration imu = *find_imu("adis16448");
  imu.T_body_camera.linear() = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  imu.T_body_camera.translation() << 0.05, -0.02, 0.1;
  return imu;
}

geometry::InertialState state_at(const CameraPath& path, const ImuCalibration& imu, double time) {
  geometry::InertialState state;
  const Eigen::Isometry3d T_camera_body = imu.T_body_camera.inverse();
  state.T_world_body = path.pose(time) * T_camera_body;
  constexpr double h = 1e-4;
  state.velocity =
      ((path.pose(time + h) * T_camera_body).translation() - (path.pose(time - h) * T_camera_body).translation()) /
      (2 * h);
  return state;
}

std::vector<ImuSample> all_samples(ImuSensor& sensor, double end) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 30 * end; ++i)
    for (const ImuSample& sample : sensor.take(i / 30.0))
      if (samples.empty() || sample.timestamp > samples.back().timestamp) samples.push_back(sample);
  return samples;
}

TEST(ImuSensor, ExactMeasurementsIntegrateToThePath) {
  for (const PathKind kind : {PathKind::xyz, PathKind::halfsphere, PathKind::rpy, PathKind::fixed}) {
    const CameraPath path = path_of(kind);
    const ImuCalibration imu = calibration();
    const ImuSensor sensor(path, imu, 1);
    std::vector<ImuSample> samples;
    for (int i = 0; i <= 1000; ++i) samples.push_back(sensor.exact(2.0 + 0.001 * i));
    const auto motion = geometry::preintegrate(samples, 2.0, 3.0, imu.noise, {});
    ASSERT_TRUE(motion);
    const auto predicted = motion->predict(state_at(path, imu, 2.0), {0, 0, -standard_gravity});
    const auto truth = state_at(path, imu, 3.0);
    EXPECT_LT((predicted.T_world_body.translation() - truth.T_world_body.translation()).norm(), 1e-4)
        << to_string(kind);
    EXPECT_LT((predicted.T_world_body.linear() - truth.T_world_body.linear()).norm(), 1e-4) << to_string(kind);
    EXPECT_LT((predicted.velocity - truth.velocity).norm(), 1e-3) << to_string(kind);
  }
}

TEST(ImuSensor, NoiseAndBiasesAreThoseOfTheSensor) {
  const CameraPath path = path_of(PathKind::fixed);
  ImuCalibration imu = calibration();
  ImuSensor sensor(path, imu, 5);
  const ImuBias bias = sensor.bias();
  EXPECT_GT(bias.gyroscope.norm(), 1e-4);
  EXPECT_LT(bias.gyroscope.norm(), 0.05);
  EXPECT_LT(bias.accelerometer.norm(), 0.5);
  const std::vector<ImuSample> samples = all_samples(sensor, 10.0);
  ASSERT_GT(samples.size(), 2000U);
  double rates = 0.0, forces = 0.0;
  for (const ImuSample& sample : samples) {
    const ImuSample exact = sensor.exact(sample.timestamp);
    rates += (sample.angular_velocity - exact.angular_velocity - bias.gyroscope).squaredNorm();
    forces += (sample.acceleration - exact.acceleration - bias.accelerometer).squaredNorm();
  }
  const double count = 3.0 * static_cast<double>(samples.size());
  EXPECT_NEAR(std::sqrt(rates / count), imu.noise.gyroscope_noise_density * std::sqrt(200.0), 2e-4);
  EXPECT_NEAR(std::sqrt(forces / count), imu.noise.accelerometer_noise_density * std::sqrt(200.0), 6e-3);
  EXPECT_THAT(imu_suspicions(samples, {imu.rate, imu.gyroscope_range, imu.accelerometer_range}), testing::IsEmpty());
}

TEST(ImuSensor, FramesGetTheSamplesSinceTheLastAndTheSameSeedTheSame) {
  ImuCalibration imu = calibration();
  imu.time_offset = 0.0123;
  ImuSensor sensor(path_of(PathKind::xyz), imu, 1), again(path_of(PathKind::xyz), imu, 1);
  double last = 0.0;
  for (const double stamp : {0.0, 0.0333, 0.0666, 0.5, 0.5333}) {
    const std::vector<ImuSample> samples = sensor.take(stamp);
    EXPECT_LE(samples.front().timestamp, last);
    EXPECT_GE(samples.back().timestamp, stamp);
    EXPECT_GT(samples[1].timestamp, last);
    EXPECT_LT(samples[samples.size() - 2].timestamp, stamp);
    EXPECT_NEAR((samples[0].timestamp + imu.time_offset) * imu.rate,
                std::round((samples[0].timestamp + imu.time_offset) * imu.rate), 1e-6)
        << "whole intervals by the clock of the IMU";
    EXPECT_EQ(samples, again.take(stamp));
    last = stamp;
  }
}

TEST(ImuSensor, MeasurementsSaturate) {
  ImuCalibration imu = calibration();
  imu.accelerometer_range = 9.0;
  ImuSensor sensor(path_of(PathKind::fixed), imu, 1);
  for (const ImuSample& sample : all_samples(sensor, 1.0)) EXPECT_LE(sample.acceleration.cwiseAbs().maxCoeff(), 9.0);
}

}  // namespace
}  // namespace holdfast::simulation
