// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/core/imu_sample.hpp"

/// The error of a state has 15 components, in this order in every function: position [m] in the world frame, rotation
/// [rad] in the body frame, velocity [m/s] in the world frame, bias of the gyroscope [rad/s], bias of the accelerometer
/// [m/s^2]. Rotations are perturbed from the right, R exp(d), all other components by addition.
namespace holdfast::geometry {

using Vector15d = Eigen::Matrix<double, 15, 1>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// Index of the first of the three components of an error.
namespace inertial {
inline constexpr int position = 0, rotation = 3, velocity = 6, gyroscope = 9, accelerometer = 12;
}

/// State of a body with an IMU at one time.
struct InertialState {
  Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the body in the world frame [m/s]
  ImuBias bias;
};

}  // namespace holdfast::geometry
