// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/geometry/inertial_state.hpp"

namespace holdfast {

namespace geometry {
class Preintegration;
}

/// Error-state Kalman filter that couples poses from images loosely with inertial measurements: preintegrated motions
/// (Forster et al. 2017, equations 45 and 47) propagate the state of the body and gravity, poses correct them. Rotation
/// and time offset of the calibration are part of the state (Li and Mourikis, "Online temporal calibration for
/// camera-IMU systems", IJRR 2014): a pose T_world_body by the nominal calibration is measured `time_offset` after the
/// state, and lacks the rotation `mounting`, as in geometry::InertialStart.
///
/// Its error has 22 components: the 15 of geometry::InertialState in the order of geometry::inertial, then gravity
/// [m/s^2] in the world frame, whose magnitude is known, rotation of the mounting [rad], time offset [s]. A value type.
class InertialFilter {
 public:
  using Covariance = Eigen::Matrix<double, 22, 22>;
  /// Of the error of a pose: position [m] in the world frame, rotation [rad] in the body frame.
  using PoseCovariance = Eigen::Matrix<double, 6, 6>;

  /// Standard deviations of a state per axis, the largest one: of the first state, without correlations.
  struct Deviations {
    double position = 0.0;       ///< [m]
    double rotation = 0.0;       ///< [rad]
    double velocity = 0.0;       ///< [m/s]
    double gyroscope = 0.0;      ///< bias [rad/s]
    double accelerometer = 0.0;  ///< bias [m/s^2]
    double direction = 0.0;      ///< of gravity [rad]
    double mounting = 0.0;       ///< [rad]
    double time_offset = 0.0;    ///< [s]
  };

  InertialFilter(const geometry::InertialState& state, const Eigen::Vector3d& gravity, const Deviations& deviations);

  /// Sets the calibration, instead of the nominal one.
  void calibrate(const Eigen::Matrix3d& mounting, double time_offset) {
    mounting_ = mounting;
    time_offset_ = time_offset;
  }
  /// Propagates the state by the measurements that follow it. `angular_velocity`: measured at their end [rad/s].
  void predict(const geometry::Preintegration& motion, const Eigen::Vector3d& angular_velocity);
  /// The pose T_world_body that is measured now, by the nominal calibration.
  Eigen::Isometry3d pose() const;
  /// Covariance of this pose.
  PoseCovariance pose_covariance() const;
  /// Squared Mahalanobis distance of a measured pose T_world_body from pose(), with six degrees of freedom.
  double chi_square(const Eigen::Isometry3d& measured, const PoseCovariance& covariance) const;
  /// Corrects the state by a measured pose T_world_body.
  void correct(const Eigen::Isometry3d& measured, const PoseCovariance& covariance);
  /// Expresses the state in another world frame, or in one that a correction of the map moved.
  void move(const Eigen::Isometry3d& T_new_old);

  const geometry::InertialState& state() const { return state_; }
  const Eigen::Vector3d& gravity() const { return gravity_; }
  const Covariance& covariance() const { return covariance_; }
  Deviations deviations() const;
  const Eigen::Matrix3d& mounting() const { return mounting_; }
  double time_offset() const { return time_offset_; }
  /// At the end of the last measurements, without the bias [rad/s].
  Eigen::Vector3d angular_velocity() const { return measured_rate_ - state_.bias.gyroscope; }

 private:
  using Observation = Eigen::Matrix<double, 6, 22>;
  Observation observation() const;
  Eigen::Matrix<double, 6, 1> innovation(const Eigen::Isometry3d& measured) const;

  geometry::InertialState state_;
  Eigen::Vector3d gravity_;
  Eigen::Matrix3d mounting_ = Eigen::Matrix3d::Identity();
  double time_offset_ = 0.0;
  Eigen::Vector3d measured_rate_ = Eigen::Vector3d::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace holdfast
