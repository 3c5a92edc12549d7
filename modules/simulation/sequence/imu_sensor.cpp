// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/imu_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::simulation {

namespace {

/// Biases of a sensor that was just switched on, of the size that calibrated consumer sensors have.
constexpr double initial_gyroscope_bias = 0.01;     // rad/s
constexpr double initial_accelerometer_bias = 0.1;  // m/s^2

Eigen::Vector3d normal_vector(Random& random, double deviation) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return deviation * Eigen::Vector3d(x, y, z);
}

}  // namespace

ImuSensor::ImuSensor(CameraPath path, const ImuCalibration& calibration, std::uint64_t seed)
    : path_(std::move(path)), calibration_(calibration), random_(Random(seed).fork(48)) {
  bias_.gyroscope = normal_vector(random_, initial_gyroscope_bias);
  bias_.accelerometer = normal_vector(random_, initial_accelerometer_bias);
  next_ = static_cast<std::int64_t>(std::floor(calibration_.time_offset * calibration_.rate));
}

ImuSample ImuSensor::exact(double timestamp) const {
  // Central differences of fourth order in a path that is analytic between its corners. It begins at rest at 0.
  constexpr double h = 5e-4;  // s
  const double time = std::max(timestamp, 2.0 * h);
  const Eigen::Isometry3d T_camera_body = calibration_.T_body_camera.inverse();
  Eigen::Isometry3d poses[5];
  for (int i = 0; i < 5; ++i) poses[i] = path_.pose(time + (i - 2) * h) * T_camera_body;
  const Eigen::Vector3d acceleration =
      (-poses[0].translation() + 16.0 * poses[1].translation() - 30.0 * poses[2].translation() +
       16.0 * poses[3].translation() - poses[4].translation()) /
      (12.0 * h * h);
  const Eigen::Matrix3d R_body_world = poses[2].linear().transpose();
  const auto turn = [&](int from, int to) -> Eigen::Vector3d {
    const Eigen::AngleAxisd rotation(Eigen::Matrix3d(poses[from].linear().transpose() * poses[to].linear()));
    return rotation.angle() * rotation.axis();
  };
  ImuSample sample;
  sample.timestamp = timestamp;
  sample.angular_velocity = (8.0 * turn(1, 3) - turn(0, 4)) / (12.0 * h);
  sample.acceleration = R_body_world * (acceleration + standard_gravity * Eigen::Vector3d::UnitZ());
  return sample;
}

ImuSample ImuSensor::measure(double timestamp) {
  const ImuNoise& noise = calibration_.noise;
  const double root_rate = std::sqrt(calibration_.rate);
  ImuSample sample = exact(timestamp);
  sample.angular_velocity += bias_.gyroscope + normal_vector(random_, noise.gyroscope_noise_density * root_rate);
  sample.acceleration += bias_.accelerometer + normal_vector(random_, noise.accelerometer_noise_density * root_rate);
  const auto limited = [](const Eigen::Vector3d& value, double range) {
    return value.cwiseMax(-range).cwiseMin(range).eval();
  };
  sample.angular_velocity = limited(sample.angular_velocity, calibration_.gyroscope_range);
  sample.acceleration = limited(sample.acceleration, calibration_.accelerometer_range);
  bias_.gyroscope += normal_vector(random_, noise.gyroscope_random_walk / root_rate);
  bias_.accelerometer += normal_vector(random_, noise.accelerometer_random_walk / root_rate);
  return sample;
}

std::vector<ImuSample> ImuSensor::take(double timestamp) {
  const double begin = last_.value_or(timestamp);
  last_ = timestamp;
  while (samples_.empty() || samples_.back().timestamp < timestamp)
    samples_.push_back(measure(static_cast<double>(next_++) / calibration_.rate - calibration_.time_offset));
  const auto is_earlier = [](double time, const ImuSample& sample) { return time < sample.timestamp; };
  auto first = std::upper_bound(samples_.begin(), samples_.end(), begin, is_earlier);
  if (first != samples_.begin()) --first;
  samples_.erase(samples_.begin(), first);
  return samples_;
}

}  // namespace holdfast::simulation
