// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// Specifications against which inertial measurements are checked.
struct ImuExpectation {
  double rate = 0.0;                 ///< samples per second; 0 = unknown
  double gyroscope_range = 0.0;      ///< [rad/s]; 0 = unknown
  double accelerometer_range = 0.0;  ///< [m/s^2]; 0 = unknown
};

/// Plausibility check of inertial measurements over at least some seconds. Each result is a clause with the finding,
/// its probable cause and the remedy. Detected are accelerations in g or without gravity, angular velocities in degrees
/// per second, different axes of gyroscope and accelerometer, gaps, an unexpected rate, and saturation. The time stamps
/// must increase. The result is empty for plausible measurements, and for recordings that are too short or at rest.
///
/// Gyroscope and accelerometer are compared by the direction of gravity, as in the attitude filter of Mahony, Hamel and
/// Pflimlin (2008): the mean specific force over 0.25 s, rotated by the integrated angular velocity, predicts the
/// direction of the mean specific force over the next 0.25 s. Angular velocities are suspected only if this prediction
/// is worse than that without any rotation, and another unit or other axes give a good one.
std::vector<std::string> imu_suspicions(std::span<const ImuSample> samples, const ImuExpectation& expected = {});

}  // namespace holdfast
