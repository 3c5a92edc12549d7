// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/imu_sample.hpp"

namespace holdfast {

/// What a map keeps of the inertial measurements of its run: the vertical of its world, its unit, and the estimates of
/// the IMU at the end. Inertial estimation in the map begins with them.
struct MapInertia {
  Eigen::Vector3d gravity{0.0, 0.0, -standard_gravity};  ///< acceleration in the world frame, points down [m/s^2]
  double scale = 1.0;                                    ///< metres in a unit of the map
  ImuBias bias;
  /// Correction of ImuCalibration::T_body_camera, whose rotation is to be multiplied by mounting^T from the left.
  Eigen::Matrix3d mounting = Eigen::Matrix3d::Identity();
  double time_offset = 0.0;  ///< correction of ImuCalibration::time_offset [s]

  // Standard deviations of these estimates, the largest axis.
  double gravity_deviation = 0.0;        ///< direction [rad]
  double gyroscope_deviation = 0.0;      ///< bias [rad/s]
  double accelerometer_deviation = 0.0;  ///< bias [m/s^2]
  double mounting_deviation = 0.0;       ///< [rad]
  double time_offset_deviation = 0.0;    ///< [s]
  // Standard deviations of poses that are tracked in the map.
  double position_deviation = 0.0;  ///< [m]
  double rotation_deviation = 0.0;  ///< [rad]

  // The calibration that biases and corrections belong to.
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  double calibrated_time_offset = 0.0;  ///< [s]
};

/// State of the IMU at a keyframe, as the last adjustment with inertial measurements found it.
struct KeyFrameMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the IMU in the world frame, in the map's unit per second
  ImuBias bias;

  /// Whether the numbers are finite and can be those of an IMU: map files refuse others.
  bool is_possible() const {
    return velocity.norm() <= 1e9 && bias.gyroscope.norm() <= 100.0 && bias.accelerometer.norm() <= 100.0;
  }
};

}  // namespace holdfast
