// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/imu.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace holdfast {

namespace {

constexpr double radians_of_a_degree = std::numbers::pi / 180.0;

/// A Bosch sensor in a camera of Intel: white noise of the data sheet, doubled for vibration and temperature, random
/// walks of ImuNoise, because data sheets have none, and the ranges that Intel's drivers set.
ImuCalibration of_data_sheet(double gyroscope, double accelerometer, double rate) {
  ImuCalibration imu;
  imu.noise.gyroscope_noise_density = 2.0 * gyroscope;
  imu.noise.accelerometer_noise_density = 2.0 * accelerometer;
  imu.rate = rate;
  imu.gyroscope_range = 1000.0 * radians_of_a_degree;
  imu.accelerometer_range = 4.0 * standard_gravity;
  return imu;
}

ImuCalibration adis16448() {
  ImuCalibration imu;
  imu.noise = {1.6968e-4, 2.0e-3, 1.9393e-5, 3.0e-3};
  imu.gyroscope_range = 1000.0 * radians_of_a_degree;
  imu.accelerometer_range = 18.0 * standard_gravity;
  return imu;
}

/// The "inflated" values of the calibration of TUM VI (Schubert et al., IROS 2018).
ImuCalibration bmi160() {
  ImuCalibration imu;
  imu.noise = {1.6e-4, 2.8e-3, 2.2e-5, 8.6e-4};
  imu.gyroscope_range = 2000.0 * radians_of_a_degree;
  imu.accelerometer_range = 16.0 * standard_gravity;
  return imu;
}

const std::array<std::pair<const char*, ImuCalibration>, 4>& known_sensors() {
  static const std::array<std::pair<const char*, ImuCalibration>, 4> sensors = {
      {{"adis16448", adis16448()},
       {"bmi055", of_data_sheet(0.014 * radians_of_a_degree, 150e-6 * standard_gravity, 200.0)},
       {"bmi085", of_data_sheet(0.014 * radians_of_a_degree, 120e-6 * standard_gravity, 200.0)},
       {"bmi160", bmi160()}}};
  return sensors;
}

}  // namespace

std::string ImuCalibration::trouble() const {
  const Eigen::Matrix3d turn = T_body_camera.linear();
  if (!T_body_camera.matrix().allFinite() || !(turn.transpose() * turn).isIdentity(1e-6) || turn.determinant() < 0.0)
    return "T_body_camera is no rigid motion; expected a rotation matrix and a translation in metres";
  if (T_body_camera.translation().norm() > 10.0)
    return "T_body_camera has a translation of " + std::to_string(T_body_camera.translation().norm()) +
           " m; expected metres, below 10";
  const auto is_positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!is_positive(noise.gyroscope_noise_density) || !is_positive(noise.accelerometer_noise_density) ||
      !is_positive(noise.gyroscope_random_walk) || !is_positive(noise.accelerometer_random_walk))
    return "has a noise density or a random walk that is not positive; expected positive numbers";
  if (!is_positive(rate) || !is_positive(gyroscope_range) || !is_positive(accelerometer_range))
    return "has a rate or a range that is not positive; expected positive numbers";
  if (!(std::abs(time_offset) <= 1.0))
    return "has a time offset of " + std::to_string(time_offset) + " s; expected seconds, between -1 and 1";
  return {};
}

std::optional<ImuCalibration> find_imu(const std::string& name) {
  for (const auto& [known, calibration] : known_sensors())
    if (name == known) {
      ImuCalibration result = calibration;
      result.name = name;
      return result;
    }
  return std::nullopt;
}

std::vector<std::string> imu_names() {
  std::vector<std::string> names;
  for (const auto& sensor : known_sensors()) names.emplace_back(sensor.first);
  return names;
}

}  // namespace holdfast
