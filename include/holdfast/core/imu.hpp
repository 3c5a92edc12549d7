// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// Calibration of an IMU: extrinsics to the camera, clock, noise and ranges.
struct ImuCalibration {
  std::string name;  ///< of a known sensor; empty for one that is given by numbers
  /// Pose of the camera in the body frame.
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  ImuNoise noise;
  double rate = 200.0;  ///< samples per second
  /// Time offset of the clocks [s]: time of the IMU = time of the camera + time_offset (Kalibr: timeshift_cam_imu).
  double time_offset = 0.0;
  double gyroscope_range = 1000.0 * std::numbers::pi / 180.0;  ///< measurements saturate at +- this value [rad/s]
  double accelerometer_range = 16.0 * standard_gravity;        ///< the same [m/s^2]

  /// Describes why the calibration cannot be used; empty if it is valid.
  std::string trouble() const;
  friend bool operator==(const ImuCalibration& a, const ImuCalibration& b) {
    return a.name == b.name && a.T_body_camera.matrix() == b.T_body_camera.matrix() && a.noise == b.noise &&
           a.rate == b.rate && a.time_offset == b.time_offset && a.gyroscope_range == b.gyroscope_range &&
           a.accelerometer_range == b.accelerometer_range;
  }
};

/// Noise, rate and ranges of an IMU known by name, with T_body_camera the identity; or nothing. Names: adis16448 (EuRoC
/// MAV, its sensor.yaml), bmi055 (Intel RealSense D435i and T265), bmi085 (Intel RealSense D455), bmi160 (TUM VI).
std::optional<ImuCalibration> find_imu(const std::string& name);
/// All names that find_imu() accepts, sorted.
std::vector<std::string> imu_names();

}  // namespace holdfast
