// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace holdfast {

/// Standard gravity [m/s^2], used by estimation and simulation; within 0.3 % of local gravity anywhere on earth.
inline constexpr double standard_gravity = 9.80665;

/// One measurement of an inertial measurement unit (IMU), a gyroscope and an accelerometer with common axes. These axes
/// and the position of the accelerometer are the body frame.
struct ImuSample {
  double timestamp = 0.0;                                      ///< [s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< of the body [rad/s]
  /// Specific force [m/s^2]: acceleration minus gravity. An IMU at rest measures 9.8 upwards.
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();

  friend bool operator==(const ImuSample&, const ImuSample&) = default;
};

/// Noise model of an IMU (Furgale, Rehder and Siegwart 2013, section III): white noise, and biases that are random
/// walks. All values are per axis. The defaults are those of a consumer sensor with a margin.
struct ImuNoise {
  double gyroscope_noise_density = 2e-4;      ///< [rad/s/sqrt(Hz)]
  double accelerometer_noise_density = 2e-3;  ///< [m/s^2/sqrt(Hz)]
  double gyroscope_random_walk = 2e-5;        ///< [rad/s^2/sqrt(Hz)]
  double accelerometer_random_walk = 1e-3;    ///< [m/s^3/sqrt(Hz)]

  friend bool operator==(const ImuNoise&, const ImuNoise&) = default;
};

/// Additive biases of an IMU: measurement = true value + bias + noise.
struct ImuBias {
  Eigen::Vector3d gyroscope = Eigen::Vector3d::Zero();      ///< [rad/s]
  Eigen::Vector3d accelerometer = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

}  // namespace holdfast
