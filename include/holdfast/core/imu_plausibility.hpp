// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// What a check of inertial measurements is told besides them.
struct ImuExpectation {
  double rate = 0.0;                 ///< samples per second; 0 = unknown
  double gyroscope_range = 0.0;      ///< [rad/s]; 0 = unknown
  double accelerometer_range = 0.0;  ///< [m/s^2]; 0 = unknown
};

/// Suspicions about inertial measurements of some seconds or more, each a clause with the finding, its probable cause
/// and the remedy: accelerations in g, or from which gravity was subtracted; rates in degrees per second; axes of the
/// gyroscope that are not those of the accelerometer; gaps; another rate than expected; saturation. Samples have
/// increasing time stamps. Empty for plausible measurements, and for what a short or resting recording leaves open.
///
/// Gyroscope and accelerometer are compared by gravity, as the attitude filter of Mahony, Hamel and Pflimlin (2008) is
/// corrected: the mean specific force of a quarter of a second, turned by the integrated rates, must point where that
/// of the next quarter points. Rates are suspected only if they predict it worse than no rotation at all, and another
/// unit or other axes predict it well.
std::vector<std::string> imu_suspicions(std::span<const ImuSample> samples, const ImuExpectation& expected = {});

}  // namespace holdfast
